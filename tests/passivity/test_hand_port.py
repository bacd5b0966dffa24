"""The hand's port of a diagram, from its own wiring."""

import numpy as np
import pytest
import sympy as sp

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller, scheduled_force_feedback
from teleopdesign.diagrams import ANY, haptic_interface
from teleopdesign.frequency import bode
from teleopdesign.passivity import damping_excess, hand_port, positive_real


def rod(damping=5.0):
    body = td.Body("prismatic", {"inertia": td.Value(0.15)})
    return body.with_effect(td.EFFECTS["viscous"], {"damping": damping})


def with_feedback(gain, bandwidth=20.0):
    h = scheduled_force_feedback(gain=gain, scheduling_velocity=0.08, bandwidth=bandwidth)
    return haptic_interface(rod(), force_feedback=h, analog=("H",))


def test_the_port_is_the_apparent_impedance_over_s():
    """Against the frequency response of the same diagram."""
    diagram = with_feedback(5.0)
    z, left_out = hand_port(diagram)
    assert left_out == ()
    f = np.geomspace(0.1, 300, 20)
    response = bode(diagram, output="E", input="L", given="L", frequency=f)
    s = 2j * np.pi * f
    assert np.abs(z(s) * s) == pytest.approx(response.data["magnitude"].values[0], rel=1e-9)


def test_force_feedback_through_a_low_pass_is_not_passive():
    """(m s + b)(tau s + 1)/(tau s + 1 + k): the real part tends to b - k m/tau."""
    tau = 1 / (2 * np.pi * 20.0)
    limit = 5.0 * tau / 0.15
    z, _ = hand_port(with_feedback(5.0))
    assert float(damping_excess(z)) == pytest.approx(5.0 - 5.0 * 0.15 / tau, rel=1e-9)
    assert positive_real(z).status == "refuted"
    assert positive_real(hand_port(with_feedback(0.99 * limit))[0]).status == "proved"
    assert positive_real(hand_port(with_feedback(1.01 * limit))[0]).status == "refuted"


def test_friction_has_no_linear_form_and_is_named():
    body = rod().with_effect(td.EFFECTS["coulomb"], {"level": 0.5})
    z, left_out = hand_port(haptic_interface(body))
    assert left_out == ("Z_M.coulomb",)
    assert positive_real(z).status == "proved"


def test_cancellation_at_a_frozen_speed_takes_damping_away():
    """F_C/(a + v) is more than the rod's own damping: active."""
    cancel = controller("smoothed_coulomb", {"level": 0.5, "smoothing_velocity": 0.015})
    diagram = haptic_interface(rod(), cancellation=cancel)
    z, _ = hand_port(diagram, speed=0.035)
    assert float(damping_excess(z)) == pytest.approx(5.0 - 0.5 / 0.05)


def test_blocks_without_values_are_one_clear_line():
    with pytest.raises(ModelError, match="known by its name only"):
        hand_port(haptic_interface(rod(), force_feedback=ANY))


def test_symbols_of_the_port_are_s_alone():
    z, _ = hand_port(with_feedback(2.0))
    assert {x.name for x in sp.sympify(z.expression).free_symbols} == {"s"}

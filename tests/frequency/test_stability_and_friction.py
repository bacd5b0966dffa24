"""Linear views say that friction is left out, and that a diagram is unstable."""

import control
import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.frequency import quasi_linear_impedance
from teleopdesign.frequency.frozen_friction import growing_modes


def rod(level=0.5):
    body = td.Body("prismatic", {"inertia": 0.15})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": level})
    return body.with_effect(td.EFFECTS["viscous"], {"damping": 0.3})


@pytest.fixture(scope="module")
def cancelled():
    hand = td.hand(mass=0.5, damping=5.0, stiffness=300.0)
    values = {"level": 0.45, "smoothing_velocity": 0.015}
    law = td.controller("smoothed_coulomb", values)
    return td.haptic_interface(rod(), hand=hand, cancellation=law)


def test_a_cancellation_without_its_friction_is_unstable_in_text_and_figure(cancelled):
    response = td.bode(cancelled)
    assert response.left_over[cancelled.name] == ("C",)
    assert "1/s" in response.unstable[cancelled.name]
    assert "UNSTABLE" in str(response) and "friction is left out" in str(response)
    drawn = response.plot().axes[0]
    assert "unstable" in drawn.get_title(loc="left")
    # its negative damper alone: 0.45/0.015 against 0.3 + 5 N s/m on 0.65 kg with 300 N/m
    poles = np.roots([0.65, 5.3 - 30.0, 300.0])
    assert f"{poles[0].real:.4g}" in response.unstable[cancelled.name]


def test_friction_is_a_damper_at_the_stated_speed(cancelled):
    speed = 0.05
    response = td.bode(cancelled, speed=speed, frequency=[1.0, 10.0])
    assert not response.unstable[cancelled.name] and not response.left_over[cancelled.name]
    damping = 0.3 + 0.5 / speed - 0.45 / (0.015 + speed)
    s = 2j * np.pi * np.array([1.0, 10.0])
    hand = 0.5 * s**2 + 5.0 * s + 300.0
    np.testing.assert_allclose(
        response.values(), hand / (hand + 0.15 * s**2 + damping * s), rtol=1e-9
    )


def test_at_an_amplitude_laws_have_their_describing_functions(cancelled):
    frequency, amplitude = np.array([2.0, 5.0]), 0.004
    free = cancelled.without("Z_H")
    felt = quasi_linear_impedance(free, amplitude=amplitude, frequency=frequency)
    z = felt.data["impedance"].values.reshape(-1)
    s = 2j * np.pi * frequency
    hand = 0.5 * s**2 + 5.0 * s + 300.0
    response = td.bode(cancelled, amplitude=amplitude, frequency=frequency)
    np.testing.assert_allclose(response.values(), hand / (hand + z), rtol=1e-6)


def test_a_mode_that_no_transfer_function_shows_counts(cancelled):
    grows = td.from_control(control.tf([1, -2], [1, -2]))
    hand = td.hand(mass=0.5, damping=5.0, stiffness=300.0)
    hidden = td.haptic_interface(rod(), hand=hand, force_feedback=grows)
    assert growing_modes(hidden) != ""

"""The loop of H: its margins against python-control, and the gain that its delay allows."""

import control
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.blocks import Body, Value
from teleopdesign.design import Assumptions, FeedbackLoop
from teleopdesign.design.device import Device, identified_delay
from teleopdesign.design.force_feedback import MOST_GAIN, force_feedback, largest_gain

from .test_friction_range import REACH


def nyquist_loop(loop):
    """The loop as a python-control system, its dead time by Pade of order 8."""
    above, below = control.pade(loop.delay, 8)
    tau = 1 / (2 * np.pi * loop.bandwidth)
    return control.tf([loop.gain], [tau, 1]) * control.tf(above, below)


@given(st.floats(1.2, 8.0), st.floats(5.0, 50.0), st.floats(5e-4, 4e-3))
def test_the_phase_margin_is_that_of_python_control(gain, bandwidth, delay):
    loop = FeedbackLoop(gain, bandwidth, delay)
    assume(5 < loop.phase_margin < 175)
    _, margin, _, crossover = control.margin(nyquist_loop(loop))
    assert loop.crossover == pytest.approx(crossover, rel=1e-4)
    # degrees; python-control interpolates
    assert loop.phase_margin == pytest.approx(margin, abs=0.1)


@given(st.floats(0.1, 1.0), st.floats(5.0, 40.0), st.floats(5e-4, 8e-3), st.floats(1.0, 5.0))
def test_the_largest_gain_is_at_its_limit_with_the_stated_delay(share, bandwidth, delay, factor):
    k = largest_gain(share=share, bandwidth=bandwidth, delay=delay, factor=factor)
    loop = FeedbackLoop(k * share, bandwidth, delay)
    assert loop.largest_delay >= factor * delay * (1 - 1e-6)
    if k < MOST_GAIN:
        assert loop.largest_delay == pytest.approx(factor * delay, rel=1e-6)


def test_a_loop_gain_below_one_bears_any_delay():
    assert FeedbackLoop(0.9, 20.0, 1.0).largest_delay == np.inf


def test_identified_lag_and_delay_of_the_actuator_count():
    body = Body("prismatic", {"inertia": Value(0.2)})
    body = body.with_effect(td.EFFECTS["actuator_lag"], {"time_constant": 3e-3})
    body = body.with_effect(td.EFFECTS["actuation_delay"], {"delay": 2e-3})
    assert identified_delay(body) == pytest.approx(5e-3)


def test_the_loop_moves_what_is_behind_a_compliance_too():
    body = Body("prismatic", {"inertia": Value(0.5)})
    tip = {"tip_inertia": 0.4, "stiffness": 1e3, "damping": 1.0}
    for effect, values, whole in (
        ("transmission_compliance", tip, 0.5),
        ("added_inertia", {"inertia": 0.2}, 0.7),
    ):
        more = body.with_effect(td.EFFECTS[effect], values)
        assert Device(more, REACH, Assumptions()).inertia == whole


@pytest.mark.parametrize("a", [0.0, 0.005, 0.5])
def test_the_schedule_keeps_residual_friction_falling(a):
    """P13: b (1 + k) >= a k."""
    body = Body("prismatic", {"inertia": Value(0.2)})
    made, _ = force_feedback(Device(body, REACH, Assumptions(load=0.6)), smoothing_velocity=a)
    values = made.controller.names()
    k, b = values["velocity_schedule.gain"], values["velocity_schedule.scheduling_velocity"]
    assert b * (1 + k) >= a * k

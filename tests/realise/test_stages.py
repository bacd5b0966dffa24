"""Stages of the actuation along a motion: a command some time later, and one that lags."""

import numpy as np
import pytest
from effects.along import body_of, motion_along

from teleopdesign.realise.along_motion import residual_along


def acting(names, values, command):
    motion = motion_along(0.01 * np.sin(np.arange(len(command)) / 30.0), command, bandwidth=200.0)
    body = body_of(*names, values=values)
    return motion, residual_along(body, motion, list(values)).acting


@pytest.mark.parametrize("delay", [0.0, 2e-3, 2.3e-3, 7.15e-3])
def test_a_late_command_is_the_earlier_one_averaged_over_each_hold(delay):
    """By a fine staircase, shifted; before the record the command is the first one."""
    whole = delay in (0.0, 2e-3)
    command = 1.0 + (
        np.random.default_rng(3).normal(size=120) if whole else np.sin(np.arange(120) / 9.0)
    )
    motion, forces = acting(("actuation_delay",), {"actuation_delay.delay": delay}, command)
    fine = 400
    shift = round(delay / 1e-3 * fine)
    held = np.concatenate([np.full(shift, command[0]), np.repeat(command, fine)])[: 120 * fine]
    expected = motion.at_rows(held.reshape(-1, fine).mean(axis=1))
    # within a row a delay is told to a quarter of it: edges of the staircase fall there
    np.testing.assert_allclose(forces.value, expected, atol=1e-9 if whole else 0.01)


def test_the_slope_by_a_delay_is_that_of_the_command_in_time():
    t = np.arange(300) * 1e-3
    motion, forces = acting(
        ("actuator_gain", "actuation_delay"),
        {"actuation_delay.delay": 4.6e-3, "actuator_gain.gain": 0.4},
        2.0 + np.sin(50 * t),
    )
    # at a row the command is half that of the hold before it and half that of the one behind it
    late = t[20:-20] - 4.6e-3 - 0.5e-3
    np.testing.assert_allclose(forces.tangent[0, 20:-20], -0.4 * 50 * np.cos(50 * late), atol=0.1)
    np.testing.assert_allclose(forces.tangent[1, 20:-20], 2.0 + np.sin(50 * late), atol=0.005)
    np.testing.assert_allclose(forces.value, 0.4 * forces.tangent[1], atol=1e-9)


def test_a_limit_acts_on_what_the_gain_makes_of_the_command():
    """3 N by a gain of one half are 1.5 N, beyond a limit of 1.2 N; 2 N are within it."""
    for size, expected in ((3.0, 1.2), (2.0, 1.0), (-3.0, -1.2)):
        _, forces = acting(
            ("actuator_gain", "actuator_saturation"),
            {"actuator_gain.gain": 0.5, "actuator_saturation.limit": 1.2},
            np.full(50, size),
        )
        np.testing.assert_allclose(forces.value, expected, rtol=1e-12)


def test_a_limit_acts_on_what_a_lag_makes_of_the_command():
    """A step to 4 N, late by 40 ms, is cut off at 3 N; limited first, it would only near 3 N."""
    t = np.arange(-50, 200) * 1e-3
    _, forces = acting(
        ("actuator_lag", "actuator_saturation"),
        {"actuator_lag.time_constant": 0.04, "actuator_saturation.limit": 3.0},
        np.where(t < 0.0, 0.0, 4.0),
    )
    expected = np.minimum(3.0, -4.0 * np.expm1(-np.maximum(t, 0.0) / 0.04))
    np.testing.assert_allclose(forces.value[5:-5], expected[5:-5], atol=0.1)

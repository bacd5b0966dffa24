"""The residual along a measured motion is what Newton's law leaves, by force, side and delay."""

from dataclasses import replace

import numpy as np
import pytest
from effects.along import body_of, motion_along, signals, unled
from scipy.integrate import solve_ivp

from teleopdesign.realise.along_motion import residual_along
from teleopdesign.realise.stages_along import INTERACTION_SHIFT, RECORD_SHIFT

INSIDE = slice(150, -150)


def recorded(seed=4, samples=700):
    return motion_along(*signals(seed, samples), resolution=1e-6)


def test_the_residual_is_what_forces_leave_of_the_acceleration():
    motion = recorded()
    values = {"viscous.damping": 3.0, "spring.stiffness": 40.0, "bias.force": 0.2,
              "coulomb.level": 0.5}  # fmt: skip
    along = residual_along(body_of("coulomb", "viscous", "spring", "bias", values=values), motion)
    force = 0.15 * motion.acceleration + 3.0 * motion.velocity + 40.0 * motion.position + 0.2
    acting_force = motion.at_rows(motion.command) + motion.interaction
    np.testing.assert_allclose(
        along.residual.value, acting_force - force - along.friction.value, atol=1e-9
    )
    np.testing.assert_allclose(along.acting.value, motion.at_rows(motion.command), atol=1e-12)
    moves = motion.direction != 0
    np.testing.assert_allclose(
        along.friction.value[moves], 0.5 * motion.direction[moves], atol=1e-12
    )
    assert moves.mean() > 0.9 and np.ptp(motion.direction) == 2


@pytest.fixture(scope="module")
def two_masses():
    """A motor of 0.1 kg and a tip of 0.05 kg on 400 N/m, pushed at the motor and at the tip."""
    m, tip, k, c, d = 0.1, 0.05, 400.0, 1.5, 2.0

    def push(t):
        return 1.5 * np.sin(30 * t) + 0.8 * np.sin(71 * t + 1)

    def hand(t):
        return 0.6 * np.sin(47 * t + 0.5)

    def rates(t, y):
        between = k * (y[0] - y[2]) + c * (y[1] - y[3])
        return y[1], (push(t) - d * y[1] - between) / m, y[3], (between + hand(t)) / tip

    t = np.arange(1200) * 1e-3
    x = solve_ivp(rates, (0, t[-1]), np.zeros(4), t_eval=t, rtol=1e-9, atol=1e-12).y[0]
    # a command is held over its row: its value in the middle of the hold
    return motion_along(x, push(t + 0.5e-3), hand(t), resolution=1e-9, bandwidth=60.0)


def device():
    """The inertia of a body is that of both sides of its spring."""
    named = {"tip_inertia": 0.05, "stiffness": 400.0, "damping": 1.5}
    values = {f"transmission_compliance.{n}": v for n, v in named.items()}
    values |= {"inertia": 0.15, "viscous.damping": 2.0}
    return body_of("viscous", "transmission_compliance", values=values)


@pytest.mark.parametrize("led", [True, False])
def test_a_tip_behind_a_spring_leaves_nothing_where_it_is_there(two_masses, led):
    body = device() if led else unled(device())
    force = two_masses.lowpassed(two_masses.at_rows(two_masses.command))[INSIDE]

    def left(body):
        residual = residual_along(body, two_masses).residual.value
        return np.linalg.norm(two_masses.lowpassed(residual)[INSIDE]) / np.linalg.norm(force)

    assert left(body) < 5e-3
    for wrong in ({"stiffness": 800.0}, {"tip_inertia": 0.1}, {"damping": 15.0}):
        named = {f"transmission_compliance.{n}": v for n, v in wrong.items()}
        assert left(body.with_values(named)) > 5 * left(body), wrong


@pytest.mark.parametrize("names", [("coulomb", "viscous"), ("viscous", "transmission_compliance")])
@pytest.mark.parametrize("late", [0.0, 2e-3])
def test_what_a_slower_sensor_of_the_hand_changes_is_a_slope_of_the_residual(names, late):
    """The hand's force is that of the log and T times its rate: by T, through hidden states too."""
    motion = replace(recorded(), interaction_late=late)
    body, h = unled(body_of(*names)), 1e-6
    along = residual_along(body, motion, ["viscous.damping", INTERACTION_SHIFT]).residual.tangent
    s = motion.spectrum.derivative(1)
    logged = motion.spectrum.multiply(motion.interaction, s / (1.0 + late * s))
    sides = [
        residual_along(body, replace(motion, interaction=motion.interaction + e * logged))
        for e in (h, -h)
    ]
    slope = (sides[0].residual.value - sides[1].residual.value) / (2 * h)
    assert np.linalg.norm(slope) > 0
    assert np.linalg.norm(along[1] - slope) < 5e-3 * np.linalg.norm(slope)
    assert np.abs(along[0]).max() > 0


@pytest.mark.parametrize("names", [("viscous",), ("viscous", "actuator_lag", "actuator_gain")])
def test_what_a_late_log_of_the_command_changes_is_the_slope_of_the_force_in_time(names):
    motion = recorded()
    body = body_of(*names)
    along = residual_along(body, motion, [RECORD_SHIFT, "viscous.damping"])
    slope = along.residual.tangent[0]
    expected = np.gradient(along.acting.value, motion.sample_time)
    assert np.abs(slope - expected)[INSIDE].max() < 0.02 * np.abs(expected).max()
    np.testing.assert_allclose(along.residual.tangent[1], -motion.velocity, atol=1e-9)


@pytest.mark.parametrize("difference", [0.2, -0.2, 0.6])
def test_friction_of_each_side_is_its_level_and_none_where_that_is_below_zero(difference):
    motion = recorded()
    named = {"coulomb.level": 0.5, "coulomb_asymmetry.half_difference": difference}
    body = body_of("coulomb", "coulomb_asymmetry", values=named)
    along = residual_along(body, motion, ["coulomb.level", "coulomb_asymmetry.half_difference"])
    ahead, back = motion.direction > 0, motion.direction < 0
    most, least = 0.5 + difference, max(0.5 - difference, 0.0)
    np.testing.assert_allclose(along.friction.value[ahead], most, rtol=1e-12)
    np.testing.assert_allclose(along.friction.value[back], -least, atol=1e-12)
    by_level, by_difference = along.friction.tangent
    assert np.all(by_level[ahead] == 1.0) and np.all(by_difference[ahead] == 1.0)
    assert np.all(by_level[back] == (-1.0 if least else 0.0))
    assert np.all(by_difference[back] == (1.0 if least else 0.0))

"""A residual force as an error of the recorded command, led back through the actuation."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from diagnose.unexplained_texture import BANDWIDTH, CHEATS, RATE, smooth_noise

from teleopdesign.blocks import Body, Value
from teleopdesign.effects import EFFECTS, Effect, Parameter
from teleopdesign.measurement.motion import motion_of
from teleopdesign.realise.along_motion import residual_along
from teleopdesign.realise.residual_at_command import (
    residual_at_command,
)
from teleopdesign.realise.traced import Traced

#: values at which each law passes some of the command everywhere along `one_way`
PASSING = {
    "actuator_gain": {"gain": 0.3},
    "actuator_lag": {"time_constant": 0.08},
    "actuation_delay": {"delay": 0.05},
    "position_dependent_gain": {"fall": 0.2, "centre": 0.3},
    "torque_ripple": {"amplitude": 0.5, "period": 0.7, "phase": 0.3},
    "actuator_saturation": {"limit": 3.2},
    "load_dependent_friction": {"coefficient": 0.4},
    "soft_limit": {"limit": 3.0},
    "forgets_what_lasts": {"part": 0.7, "time_constant": 0.5},
    "takes_up_what_acts": {"part": 0.6},
    "feeds_back_late": {"part": 0.6, "time_constant": 0.3},
}


def one_way(side=1):
    """A slide in one direction, its command between 2 and 4 N."""
    rng, n = np.random.default_rng(3), int(12 * RATE)
    speed = 0.3 * (1 + 0.2 * smooth_noise(rng, n, 1.0))
    return motion_of(
        body="device",
        file="made",
        time=np.arange(n) / RATE,
        position=side * np.cumsum(np.maximum(speed, 0.05)) / RATE,
        command=side * np.clip(3.0 + 0.4 * smooth_noise(rng, n, 2.0), 2.0, 4.0),
        interaction=None,
        sample_time=1 / RATE,
        rows=slice(0, n),
        bandwidth=BANDWIDTH,
        resolution=1e-6,
    )


def body_with(effect, values):
    parameters = {f"{effect.name}.{n}": Value(v) for n, v in values.items()}
    return Body(
        axis="prismatic",
        parameters={"inertia": Value(0.2), "coulomb.level": Value(1.0), **parameters},
        effects=(EFFECTS["coulomb"], effect),
    )


@pytest.mark.parametrize("name", PASSING)
def test_an_error_of_the_command_is_led_back_as_what_it_was(name):
    """r(u + d) - r(u) mapped back is d, by every law that could stand between, a user's own too."""
    effect = {**EFFECTS, **CHEATS}[name]
    motion, body = one_way(), body_with(effect, PASSING[name])
    error = 1e-4 * smooth_noise(np.random.default_rng(5), len(motion.time), 2.0)
    before = residual_along(body, motion)
    after = residual_along(body, replace(motion, command=motion.command + error))
    made = after.residual.value - before.residual.value
    along = replace(before, residual=Traced(made, before.residual.tangent))
    command_error = residual_at_command(body, motion, along)
    # a slow memory begins with the record, and is forgotten after some seconds
    inside = slice(4 * int(RATE), -int(RATE))
    valid_rows = ~command_error.blind[inside]
    left = motion.lowpassed(command_error.residual - motion.at_rows(error))[inside][valid_rows]
    assert np.mean(valid_rows) > 0.6
    if name == "actuator_saturation":
        # the low-pass smears what is blind into what is not, a fifth of a second to either side
        near = (
            np.convolve(command_error.blind, np.ones(int(0.4 * RATE)), "same")[inside][valid_rows]
            > 0
        )
        left = left[~near]
    # coefficients of what has a memory are taken at their mean: 6 % where a gain varies by 20 %
    assert np.sqrt(np.mean(left**2)) < 0.06 * np.std(error)


def test_actuation_is_led_back_as_the_format_says():
    """Gain g: r / g.  Lag: (1 + tau s) r.  Delay: earlier by it."""
    motion = one_way()
    t, omega = motion.time, 2 * np.pi * 1.5
    wave = np.sin(omega * t)
    expected = {
        "actuator_gain": wave / 0.3,
        "actuator_lag": wave + 0.08 * omega * np.cos(omega * t),
        "actuation_delay": np.sin(omega * (t + 0.05)),
    }
    inside = slice(int(RATE), -int(RATE))
    for name, known in expected.items():
        body = body_with(EFFECTS[name], PASSING[name])
        along = residual_along(body, motion)
        along = replace(along, residual=Traced(wave, along.residual.tangent))
        forces = residual_at_command(body, motion, along)
        assert not forces.blind.any()
        # the lag is simulated on quarters of a sample, exactly: what differs is the ends' echo
        np.testing.assert_allclose(forces.residual[inside], known[inside], atol=0.01)


@pytest.mark.parametrize("side", [1, -1])
def test_samples_beyond_a_limit_are_blind(side):
    motion = one_way(side)
    command_error = residual_at_command(
        body_with(EFFECTS["actuator_saturation"], {"limit": 3.0}), motion
    )
    np.testing.assert_array_equal(command_error.blind, side * motion.command > 3.0)


@pytest.mark.parametrize("side", [1, -1])
def test_samples_in_which_friction_takes_up_the_whole_force_are_blind_then_and_not_earlier(side):
    """A user's brake that holds all of the acting force along a part of the stroke."""
    brake = Effect(
        role="friction_level",
        law=lambda now, p: sp.Piecewise(
            (p.part * sp.Abs(now.acting_force), sp.Abs(now.position) > 1.5), (0, True)
        ),
        parameters={"part": Parameter("dimensionless", "share")},
        absent={"part": 0.0},
    ).named("brake", "")
    motion = one_way(side)
    held = np.abs(motion.position) > 1.5
    assert 0.2 < held.mean() < 0.8
    command_error = residual_at_command(body_with(brake, {"part": 1.0}), motion)
    moves = motion.direction != 0  # all samples but the last
    np.testing.assert_array_equal(command_error.blind[moves], held[moves])
    assert not residual_at_command(body_with(brake, {"part": 0.5}), motion).blind.any()

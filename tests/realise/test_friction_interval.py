"""The friction interval holds every level that the body's law takes, and is one everywhere."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
import sympy as sp
from effects.along import typical, with_needs
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.effects import EFFECTS, SIGNALS, Effect, Parameter, State
from teleopdesign.passivity.identified import identify_device
from teleopdesign.realise.damping_interval import (
    damping_interval,
    largest_acting_force,
    small_motion_damping,
)
from teleopdesign.realise.friction_interval import friction_interval
from teleopdesign.realise.reach import Reach

REACH = Reach(
    low=-0.05, high=0.05, peak_speed=0.3, rms_speed=0.1, command=3.0, duration=10.0,
    sample_period=1e-3, step=5e-6, unresolved=2e-5, measures_force=True,
)  # fmt: skip
LEVELS = [
    n for n, e in EFFECTS.items() if e.role in ("friction_level", "friction_factor") and e.needs
]


def body_of(values, errors=None):
    """A body of 0.1 kg with these parameters, {"coulomb.level": 0.5, ...}, and standard errors."""
    body = td.Body("prismatic", {"inertia": td.Value(0.1)})
    for name in dict.fromkeys(n.partition(".")[0] for n in values):
        parameters = {n.partition(".")[2]: v for n, v in values.items() if n.startswith(f"{name}.")}
        body = body.with_effect(EFFECTS[name], parameters)
    errors = errors or {}
    return body.with_values({n: td.Value(values[n], stderr=e) for n, e in errors.items()})


@st.composite
def bodies(draw):
    """Coulomb friction with effects that shape its level, and standard errors of all of them."""
    chosen = draw(st.lists(st.sampled_from(LEVELS), unique=True, max_size=3))
    names = list(dict.fromkeys(n for c in ["coulomb", *chosen] for n in with_needs(c)))
    values = {
        f"{n}.{p}": typical(n, p) * draw(st.floats(0.3, 1.5))
        for n in names
        for p in EFFECTS[n].parameters
    }
    errors = {n: v * draw(st.sampled_from([0.0, 0.01, 0.1])) for n, v in values.items()}
    return body_of(values, errors)


def levels_at(body, rng, number, errors, reach=REACH):
    """The level at random signals within the reach and parameters within their errors."""
    symbols = [*SIGNALS.values(), *body.symbols().values()]
    law = sp.lambdify(symbols, body.level(), "numpy")
    direction = rng.choice([-1.0, 1.0], number)
    speed = 3.0 * rng.choice([0.0, 1.0, 1e-3, 1e-2], number) * rng.uniform(0, 1, number)
    signals = {n: rng.uniform(-1, 1, number) for n in SIGNALS} | {
        "direction": direction,
        "velocity": direction * speed,
        "position": rng.uniform(reach.low, reach.high, number),
        "time": rng.choice([0.0, 1.0, 1000.0], number) * rng.uniform(0, 1, number),
        "acting_force": rng.uniform(-reach.command, reach.command, number),
    }
    parameters = []
    for name in body.symbols():
        value, declared = body.parameters[name], body.parameter(name)
        half = errors * (value.stderr if np.isfinite(value.stderr) else 0.0)
        moved = value.value + half * rng.choice([-1.0, 0.0, 1.0], number)
        parameters.append(np.clip(moved, declared.lower, declared.upper))
    return np.broadcast_to(law(*signals.values(), *parameters), number)


def check_levels_within(body, seed):
    interval = friction_interval(body, REACH, errors=2.0)
    rounding = 1e-13 * abs(interval.highest.high)  # of the law in floats
    rng = np.random.default_rng(seed)
    within = levels_at(body, rng, 4000, errors=2.0)
    assert interval.lowest.low - rounding <= within.min()
    assert within.max() <= interval.highest.high + rounding
    at_estimate = levels_at(body, rng, 4000, errors=0.0)
    assert interval.lowest.estimate - rounding <= at_estimate.min()
    assert at_estimate.max() <= interval.highest.estimate + rounding
    assert interval.lowest.low <= interval.lowest.estimate <= interval.lowest.high
    assert interval.highest.low <= interval.highest.estimate <= interval.highest.high
    return interval


@pytest.mark.slow
@settings(max_examples=8)
@given(body=bodies(), seed=st.integers(0, 2**31))
def test_a_wider_reach_has_no_narrower_interval(body, seed):
    interval = check_levels_within(body, seed)
    everywhere = friction_interval(body, None, errors=2.0)
    # both are bounds, met within 1e-4 of a level
    assert everywhere.lowest.low <= interval.lowest.low + 1e-4 * interval.highest.high


def test_a_constant_level_is_the_number_that_was_given():
    interval = friction_interval(body_of({"coulomb.level": 0.3}), errors=1.96)
    assert (interval.lowest.low, interval.lowest.estimate, interval.lowest.high) == (0.3, 0.3, 0.3)
    assert interval.over == interval.where_lowest == "any motion"
    stribeck = {"stribeck.extra_static_level": 0.2, "stribeck.stribeck_velocity": 0.01}
    interval = friction_interval(body_of({"coulomb.level": 0.3} | stribeck), errors=1.96)
    assert interval.lowest.low == 0.3
    assert interval.highest.high == pytest.approx(0.5, rel=1e-14)


WAVE = {
    "coulomb.level": 1.0,
    "stribeck.extra_static_level": 0.4,
    "stribeck.stribeck_velocity": 0.02,
    "position_dependent_friction.amplitude": 0.2,
    "position_dependent_friction.period": 0.05,
    "position_dependent_friction.phase": 0.3,
}
WAVE_ERRORS = {
    "coulomb.level": 0.05,
    "position_dependent_friction.amplitude": 0.02,
    "position_dependent_friction.period": 0.002,
    "position_dependent_friction.phase": 0.1,
}


@pytest.mark.slow
@pytest.mark.parametrize("reach", [REACH, None])
def test_a_wave_of_unknown_phase_counts_for_its_amplitude(reach):
    """A slope in the period times ten metres of position would make it -2.7 N."""
    interval = friction_interval(body_of(WAVE, WAVE_ERRORS), reach, errors=2.0)
    assert interval.lowest.low == pytest.approx(0.9 * (1 - 0.24), rel=1e-4)
    assert interval.highest.high == pytest.approx(1.1 * (1 + 0.24) + 0.4, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("asymmetry", [-0.1, 0.15])
def test_a_wave_beside_a_load_over_every_motion_holds_all_levels(asymmetry):
    """The laws that take longest: sampled over places and loads up to 100 m and 1000 N."""
    load = {"coefficient": 0.2, "driving_difference": 0.1, "extra_at_rest": 0.3}
    load |= {"stribeck_velocity": 0.05, "output_share": 0.0}
    values = WAVE | {f"load_dependent_friction.{n}": v for n, v in load.items()}
    values["coulomb_asymmetry.half_difference"] = asymmetry
    errors = WAVE_ERRORS | {"load_dependent_friction.coefficient": 0.01}
    body = body_of(values, errors)
    interval = friction_interval(body, None, errors=2.0)
    assert interval.highest.low == inf
    assert interval.lowest.low == pytest.approx(0.9 * (1 - 0.24) - abs(asymmetry), rel=1e-4)
    wide = replace(REACH, low=-100.0, high=100.0, command=1e3, peak_speed=10.0)
    levels = levels_at(body, np.random.default_rng(5), 20000, errors=2.0, reach=wide)
    assert interval.lowest.low <= levels.min()


def test_friction_of_the_load_has_no_upper_bound_until_the_load_has():
    values = {"coulomb.level": 0.5, "load_dependent_friction.coefficient": 0.1}
    assert friction_interval(body_of(values), errors=2.0).highest.estimate == inf
    interval = friction_interval(body_of(values), REACH, errors=2.0)
    assert interval.highest.estimate == pytest.approx(0.8)
    assert interval.over == "acting force -3 to 3 N"
    values["presliding.stiffness"] = 1e4
    with pytest.raises(ModelError, match="no upper bound of the friction level.*give the experi"):
        identify_device(body_of(values))
    assert identify_device(body_of(values), REACH).highest.high == pytest.approx(0.8)


def user(law, role="friction_level", **more):
    """A user's own effect with one parameter, `size`."""
    parameters = {"size": Parameter("force", "size")}
    made = Effect(role=role, law=law, parameters=parameters, absent={"size": 0.0}, **more)
    return made.named("own", "Own.")


def with_users_effect(effect, size=0.1, base=None):
    body = body_of(base or {"coulomb.level": 0.5})
    return body.with_effect(effect, {"size": size})


# what acts, and what damps


def test_an_actuation_makes_no_more_of_a_command_than_its_bound():
    values = {
        "actuator_gain.gain": 1.1,
        "torque_ripple.amplitude": 0.2,
        "torque_ripple.period": 0.05,
        "torque_ripple.phase": 0.0,
        "actuator_lag.time_constant": 0.01,
        "actuation_delay.delay": 2e-3,
        "actuator_saturation.limit": 0.5,
    }
    body = body_of(values, {"actuator_gain.gain": 0.05})
    assert largest_acting_force(body, 0.1, errors=2.0) == pytest.approx(0.1 * 1.2 * 1.2, rel=1e-4)
    assert largest_acting_force(body, 10.0, errors=2.0) == 0.5
    resonant = user(
        lambda now, p: now.out,
        role="actuation",
        states={"out": State("force", lambda now, p: (2 * now.command - now.out) / p.size)},
    )
    assert largest_acting_force(with_users_effect(resonant), 1.0, errors=2.0) == inf


def test_damping_is_that_of_the_worse_direction_at_every_speed():
    values = {
        "viscous.damping": 2.0,
        "viscous_asymmetry.half_difference": -0.5,
        "quadratic_drag.drag": 1.0,
    }
    interval = damping_interval(body_of(values, {"viscous.damping": 0.1}), errors=2.0)
    assert (interval.least.low, interval.least.estimate) == pytest.approx((1.3, 1.5))
    assert interval.supplying == ()
    values["viscous_asymmetry.half_difference"] = -3.0
    interval = damping_interval(body_of(values), errors=2.0)
    assert interval.supplying == ("viscous_asymmetry",)
    assert interval.least.low == pytest.approx(2.0)


def test_a_users_damper_counts_in_small_motion_under_any_name():
    damper = user(lambda now, p: p.size * now.velocity, role="force", energy="dissipates")
    body = with_users_effect(damper, size=1.5, base={"coulomb.level": 0.5, "viscous.damping": 2.0})
    assert small_motion_damping(body, errors=0.0) == pytest.approx(3.5)
    presliding = {"stiffness": 1e4, "bristle_damping": 4.0}
    bristle = body.with_effect(EFFECTS["presliding"], presliding)
    assert small_motion_damping(bristle, errors=0.0) == pytest.approx(7.5)
    pushing = user(lambda now, p: -p.size * now.velocity, role="force")
    undeclared = with_users_effect(pushing)
    assert damping_interval(undeclared, errors=0.0).supplying == ("own",)

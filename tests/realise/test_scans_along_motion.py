"""Hidden states along a measured motion: against solutions by other means, and by their slopes."""

from dataclasses import replace

import numpy as np
import pytest
from effects.along import body_of, motion_along, signals, unled
from scipy.integrate import solve_ivp

from teleopdesign.effects import SIGNALS
from teleopdesign.realise.along_motion import residual_along
from teleopdesign.realise.scan import coupled_scan
from teleopdesign.realise.traced import Along, Traced

RATE = 1000.0


def recorded(seed=4, samples=700, **more):
    return motion_along(*signals(seed, samples), resolution=1e-6, **more)


def tip_of(body, x, v, a, rate):
    """Position of the tip behind a body that moves so, led by nothing."""
    (effect,) = unled(body).effects
    none = np.zeros((0, len(x)))
    signals = zip(("position", "velocity", "acceleration"), (x, v, a), strict=True)
    known = {SIGNALS[n]: Traced(y, none) for n, y in signals}
    known[SIGNALS["interaction_force"]] = Traced(np.zeros(len(x)), none)
    hidden = coupled_scan(effect, Along(known, body.numbers(), (), 1 / rate))
    return hidden[effect.state_symbols()["tip_position"]].value


@pytest.mark.parametrize(("offset", "rate"), [(0.0, 500.0), (0.3, 500.0), (0.3, 2000.0)])
def test_a_tip_starts_where_the_body_is_and_swings_as_another_solver_says(offset, rate):
    """A body that is away from zero, and moves, when the record begins."""
    values = {"tip_inertia": 0.05, "stiffness": 400.0, "damping": 1.5}
    body = body_of(
        "transmission_compliance",
        values={f"transmission_compliance.{n}": v for n, v in values.items()},
    )

    def x(t):
        return offset + 0.01 * np.sin(40 * t + 0.4), 0.4 * np.cos(40 * t + 0.4)

    def rates(t, y):
        here, fast = x(t)
        return y[1], (400.0 * (here - y[0]) + 1.5 * (fast - y[1])) / 0.05

    t = np.arange(int(0.4 * rate)) / rate
    here, fast = x(t)
    known = solve_ivp(rates, (0, t[-1]), [here[0], fast[0]], t_eval=t, rtol=1e-9, atol=1e-12).y[0]
    tip = tip_of(body, here, fast, -1600.0 * (here - offset), rate)
    # the body's course between rows is a parabola through what is known at both ends
    assert np.abs(tip - known).max() < 2e-4 * 0.01
    assert np.abs(tip - here).max() > 0.1 * 0.01


def test_elements_that_slip_in_turn_are_those_of_a_loop_by_hand():
    """Each follows the travel up to its level and stays there; the first has what is left."""
    level, stiffness, part = 0.5, (3e3, 800.0, 200.0, 60.0), (0.12, 0.08, 0.05)
    names = ("stiffness_1", "stiffness_2", "stiffness_3", "stiffness_4")
    values = {f"maxwell_slip.{n}": k for n, k in zip(names, stiffness, strict=True)}
    values |= {f"maxwell_slip.level_{i + 2}": p for i, p in enumerate(part)}
    motion = recorded()
    body = body_of("coulomb", "maxwell_slip", values=values | {"coulomb.level": level})
    whole = residual_along(body, motion)
    along, needed = whole.friction.value, whole.residual.value + whole.friction.value
    most = np.array([level - sum(part), *part])
    at_start = round(0.5 / motion.bandwidth / motion.sample_time)
    force, forces = most * np.clip(needed[:at_start].mean() / level, -1.0, 1.0), []
    for step in np.diff(motion.position, prepend=motion.position[0]):
        force = np.clip(force + np.array(stiffness) * step, -most, most)
        forces.append(force.sum())
    moving = motion.direction != 0
    np.testing.assert_allclose(along[moving], np.array(forces)[moving], atol=1e-9)
    assert np.ptp(along) > 1.5 * level and moving.mean() > 0.9


@pytest.mark.parametrize(("shape", "left"), [("presliding", 0.02), ("maxwell_slip", 0.2)])
@pytest.mark.parametrize("cut", [350, 600, 900, 1300])
def test_a_record_that_begins_in_the_middle_has_the_friction_of_the_whole(shape, left, cut):
    """It was zero there, and wrong by up to 0.5 N until the body slid.

    What several elements have each, their sum does not tell.
    """
    values = {
        "presliding": {"presliding.stiffness": 400.0},
        "maxwell_slip": {
            "maxwell_slip.stiffness_1": 150.0, "maxwell_slip.stiffness_2": 900.0,
            "maxwell_slip.level_2": 0.2,
        },
    }[shape]  # fmt: skip
    body = body_of("coulomb", shape, values=values | {"coulomb.level": 0.5})
    t = np.arange(3000) / RATE
    x = 1e-3 * np.sin(3.0 * t) + 4e-4 * np.sin(7.0 * t)  # it slides and turns
    silent = residual_along(body, motion_along(x, 0.0 * x, resolution=1e-6))
    # the command that leaves nothing
    needed = -silent.residual.value
    whole = residual_along(body, motion_along(x, needed, resolution=1e-6)).friction.value
    part = residual_along(body, motion_along(x[cut:], needed[cut:], resolution=1e-6))
    assert np.ptp(whole) > 0.7
    assert np.abs(part.friction.value - whole[cut:])[100:-100].max() < left


def test_where_a_reading_tells_no_motion_friction_is_what_balances_within_a_step():
    """A bristle of k N/m is open by k times half a step of the encoder, and by no more."""
    step, stiffness, n = 1e-4, 1e3, 600
    x = np.repeat(np.arange(6), 100) * step
    for size in (0.01, 0.3):
        command = size * np.sin(np.arange(n) / 40.0)
        motion = motion_along(x, command, resolution=step, bandwidth=100.0)
        body = body_of("coulomb", "presliding", values={"presliding.stiffness": stiffness})
        along = residual_along(body, motion)
        still = motion.direction == 0
        assert still.sum() > 100
        # what the bristle has by its travel, and how far the needed force is from it
        sure = body_of("coulomb", "presliding", values={"presliding.stiffness": stiffness})
        middle = residual_along(sure, replace(motion, direction=np.ones(n))).friction.value
        assert np.abs(along.friction.value - middle)[still].max() <= stiffness * step / 2 + 1e-9

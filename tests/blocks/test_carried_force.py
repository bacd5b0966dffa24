"""The force that a transmission carries: of its load, or of what arrives less what is lost."""

import numpy as np
import pytest
import sympy as sp
from effects.along import encoded, motion_along, signals
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign import ModelError
from teleopdesign.blocks import Body, Value, solve_carried_force
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS, SIGNALS, Effect, Parameter
from teleopdesign.realise.along_motion import residual_along
from teleopdesign.realise.residual_at_command import residual_at_command
from teleopdesign.simulate import simulate

INERTIA, LEVEL, DAMPING, GRAVITY = 0.05, 0.3, 0.4, 2.0
CARRIED = SIGNALS["carried_force"]


def geared(mu, *, driving=0.0, level=LEVEL, share=1.0, more=()):
    """A pendulum on a gear that rubs with what it carries."""
    stated = {
        "coulomb": {"level": level},
        "viscous": {"damping": DAMPING},
        "gravity": {"amplitude": GRAVITY, "phase": 0.0},
        "load_dependent_friction": {
            "coefficient": mu, "driving_difference": driving, "output_share": share,
        },
    }  # fmt: skip
    body = Body("revolute", {"inertia": Value(INERTIA)})
    for name in (*stated, *more):
        body = body.with_effect(EFFECTS[name], stated.get(name))
    return body


def test_its_load_is_inertia_and_forces_of_the_place_without_the_hands():
    x, v, a, hand = (
        SIGNALS[n] for n in ("position", "velocity", "acceleration", "interaction_force")
    )
    body = geared(0.2, more=("quadratic_drag", "bias"))
    carried = body.carried_force().subs(body.numbers() | {body.symbols()["bias.force"]: 0.7})
    expected = INERTIA * a + GRAVITY * sp.sin(x) + 0.7 - hand
    assert sp.simplify(carried - expected) == 0
    assert not carried.has(v), "damping is lost before it"


@pytest.mark.slow
@given(
    force=st.floats(-20, 20),
    speed=st.floats(-3, 3).filter(lambda v: abs(v) > 1e-3),
    mu=st.floats(0, 0.9),
    driving=st.floats(-0.1, 0.1),
)
def test_what_is_lost_and_what_is_carried_are_what_acts(force, speed, mu, driving):
    """Newton's law of the body with the level that the solved force makes."""
    body = geared(mu, driving=driving)
    effects = body.effects
    equation = solve_carried_force(body.equation(), effects)
    assert not equation.friction.has(CARRIED)
    now = body.numbers() | {
        SIGNALS["acting_force"]: force,
        SIGNALS["velocity"]: speed,
        SIGNALS["direction"]: np.sign(speed),
    }
    friction = float(equation.friction.subs(now))
    carried = force - DAMPING * speed - friction
    way = np.sign(speed)
    expected = LEVEL + mu * abs(carried) * (1 + driving * np.sign(carried) * way)
    assert friction == pytest.approx(way * expected, rel=1e-9, abs=1e-9)


def test_a_level_that_is_not_in_proportion_has_no_simulated_form():
    root = Effect(
        role="friction_level",
        law=lambda now, p: p.level * sp.sqrt(sp.Abs(now.carried_force)),
        parameters={"level": Parameter("force", "level at 1 N")},
        absent={"level": 0.0},
        source="a test",
        name="root_of_the_load",
        text="Level that grows as the root of the load.\n\n    W = c sqrt(abs(L))\n",
    )
    body = Body("revolute", {"inertia": 0.1}).with_effect(root, {"level": 1.0})
    with pytest.raises(ModelError, match="not in proportion to now.carried_force"):
        simulate(haptic_interface(body), duration=0.01, jit=False)


@pytest.mark.slow
@pytest.mark.parametrize("lost", [0.2, 0.6])
def test_a_load_that_drives_back_brakes_and_does_not_run_away(lost):
    """A pendulum let go at 1 rad: with mu = 0.6 on each side it comes to rest sooner."""
    free, geared_down = (
        simulate(
            haptic_interface(geared(mu, level=0.02)),
            duration=1.0,
            initial={"L": 1.0},
            jit=False,
            step=2e-4,
        )
        for mu in (0.0, lost)
    )
    swung, braked = (np.abs(s["L"].values).max() for s in (free, geared_down))
    assert braked <= swung + 1e-9
    work = np.abs(free["L_velocity"].values).max(), np.abs(geared_down["L_velocity"].values).max()
    assert work[1] < work[0]


def test_friction_of_the_load_takes_nothing_of_the_command():
    """Of the acting force it takes a part: then less of the command moves the body."""
    x, u, f = signals()
    motion = motion_along(encoded(x), u, f, resolution=1e-6)
    r = residual_along(geared(0.4), motion).residual.value
    np.testing.assert_allclose(residual_at_command(geared(0.4), motion).residual, r, rtol=1e-9)
    hidden = geared(0.4, share=0.0)
    other = residual_along(hidden, motion).residual.value
    assert (
        np.abs(residual_at_command(hidden, motion).residual - other).max()
        > 0.1 * np.abs(other).max()
    )

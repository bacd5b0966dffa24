"""The course of a tip that searches begin at, held against an integration of the effects' laws."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from teleopdesign.effects.backlash import coupling
from teleopdesign.realise.tip_along import tip_along

DT = 1e-3
TIME = np.arange(0.0, 2.0, DT)
POSITION = 0.02 * np.sin(2 * np.pi * 1.3 * TIME) + 0.004 * np.sin(2 * np.pi * 4.1 * TIME + 1.0)
VELOCITY = np.gradient(POSITION, DT)
STRETCH, RATE = sp.symbols("stretch rate")


def integrated(*, gap, swing, damping_ratio, slowing):
    """The same by the effect's own coupling, per unit of inertia, and a smooth sgn of friction."""
    values = {"stiffness": swing**2, "damping": 2 * damping_ratio * swing, "gap": gap}
    law = coupling(SimpleNamespace(stretch=STRETCH, stretch_rate=RATE), SimpleNamespace(**values))
    force = sp.lambdify((STRETCH, RATE), law)
    eps = 1e-4

    def pull(t, y, w):
        x, v = np.interp(t, TIME, POSITION), np.interp(t, TIME, VELOCITY)
        return float(force(x - y, v - w))

    def slope(t, state):
        y, w = state
        return w, pull(t, y, w) - slowing * np.tanh(w / eps)

    run = solve_ivp(
        slope, (0.0, TIME[-1]), (POSITION[0], VELOCITY[0]), t_eval=TIME, method="LSODA",
        rtol=1e-6, atol=1e-9, max_step=DT,
    )  # fmt: skip
    return np.array([pull(t, y, w) for t, y, w in zip(TIME, *run.y, strict=True)])


@pytest.mark.parametrize(
    ("gap", "slowing"),
    [(0.004, 0.6), *(pytest.param(*x, marks=pytest.mark.slow) for x in [(0.0, 0.5), (0.004, 0.0)])],
)
def test_a_tip_takes_what_its_effects_say(gap, slowing):
    course = {"gap": gap, "swing": 60.0, "damping_ratio": 0.3, "slowing": slowing}
    mine, theirs = tip_along(POSITION, VELOCITY, DT, **course), integrated(**course)
    assert np.linalg.norm(mine - theirs) < 0.1 * np.linalg.norm(theirs)


@settings(max_examples=30, deadline=None)
@given(
    gap=st.floats(0.0, 0.05), swing=st.floats(1.0, 2000.0), ratio=st.floats(0.0, 1.0),
    slowing=st.floats(0.0, 10.0),
)  # fmt: skip
def test_a_course_is_finite_and_turns_round_with_the_axis(gap, swing, ratio, slowing):
    course = {"gap": gap, "swing": swing, "damping_ratio": ratio, "slowing": slowing}
    there = tip_along(POSITION, VELOCITY, DT, **course)
    assert there.shape == POSITION.shape and np.isfinite(there).all()
    assert np.array_equal(tip_along(-POSITION, -VELOCITY, DT, **course), -there)


def test_a_stiff_tip_without_friction_moves_with_the_body_and_a_wide_gap_leaves_it_alone():
    course = {"swing": 2000.0, "damping_ratio": 0.5, "slowing": 0.0}
    stiff = tip_along(POSITION, VELOCITY, DT, gap=0.0, **course)
    acceleration = np.gradient(VELOCITY, DT)
    inner = slice(50, -50)
    assert np.linalg.norm((stiff - acceleration)[inner]) < 0.05 * np.linalg.norm(acceleration)
    held = {**course, "slowing": 1e3}
    assert not tip_along(POSITION, VELOCITY, DT, gap=1.0, **held).any()

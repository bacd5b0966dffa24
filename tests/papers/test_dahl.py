"""Dahl model and its discrete forms: Mahvash, Okamura, ICRA 2006."""

from math import exp

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.blocks import Body, Value
from teleopdesign.controllers import CONTROLLERS, SIGNALS, controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.simulate import sampled_motion, simulate

LEVEL, STIFFNESS = 0.5, 5e3
f, f_c, sigma, v, x, T = sp.symbols("f f_c sigma v x T", real=True)


def force_rate(speed, force):
    """Rate of the force of the controller `dahl`, from its own law."""
    made = controller("dahl", {"level": LEVEL, "stiffness": STIFFNESS}).equation("C", SIGNALS)
    (state,) = made.rates
    names = {"C_dahl_level": f_c, "C_dahl_stiffness": sigma, "travel_rate": speed}
    values = {s: names[s.name] for s in made.rates[state].free_symbols if s.name in names}
    return sp.expand(
        (sigma * made.rates[state]).subs(values, simultaneous=True).subs(state, force / sigma)
    )


def sampled(positions, level=LEVEL, stiffness=STIFFNESS):
    """Force of the sampled compensator for these positions, from the generated code itself."""
    body = Body("prismatic", {"inertia": Value(1.0)})
    diagram = haptic_interface(
        body, cancellation=controller("dahl", {"level": level, "stiffness": stiffness})
    )
    time = 1e-3 * np.arange(len(positions))
    result = simulate(
        diagram,
        duration=time[-1],
        motion={"L": _held(positions)},
        step=1e-3,
        jit=False,
    )
    return result["R_MBC"].values


def _held(positions):
    from teleopdesign.simulate import Trajectory

    table = np.asarray(positions, dtype=float)

    def position(t):
        return table[np.clip(np.round(t / 1e-3).astype(int), 0, len(table) - 1)]

    return Trajectory(position, np.zeros_like, np.zeros_like)


def exact(force, dx, level=LEVEL, stiffness=STIFFNESS):
    """Eq (9) with s = sgn(dx)."""
    s = np.sign(dx)
    return level * s + (force - level * s) * exp(-stiffness / level * abs(dx))


def test_the_rate_of_the_force_is_the_papers():
    """Eq (2): df/dt = sigma v (1 - f/f_c sgn v) = sigma v - (sigma/f_c) abs(v) f."""
    assert sp.simplify(force_rate(v, f) - (sigma * v - sigma / f_c * sp.Abs(v) * f)) == 0


def test_the_sampled_compensator_is_the_exact_solution_over_the_travel():
    """Eq (9), with s = sgn(x_next - x): the generated code, sample by sample."""
    positions = 1e-4 * np.array([0.0, 0.3, 0.9, 0.9, 0.5, -0.4, -3.0, 2.0, 2.0, 2.1])
    force = 0.0
    for sample, dx in zip(sampled(positions)[1:], np.diff(positions), strict=True):
        force = exact(force, dx)
        assert sample == pytest.approx(force, abs=1e-14)


@given(st.lists(st.floats(-2e-3, 2e-3), min_size=2, max_size=8))
def test_the_force_stays_within_its_level_for_any_positions(steps):
    """Eq (9) keeps abs(f) <= f_c for every sequence of positions; travel 0 keeps the force."""
    positions = np.concatenate([[0.0], np.cumsum(steps)])
    positions = np.append(positions, positions[-1])
    force = sampled(positions)
    assert np.abs(force).max() <= LEVEL * (1 + 1e-12)
    assert force[-1] == force[-2]


def test_travel_in_parts_is_travel_at_once():
    """Semigroup property of eq (9), to rounding."""
    parts = sampled(np.linspace(0.0, 2e-4, 11))[-1]
    assert parts == pytest.approx(sampled([0.0, 2e-4])[-1], rel=1e-13)


def test_presliding_and_the_compensator_are_one_law():
    """The compensator's law is the effect's own, not a copy."""
    effect = EFFECTS["presliding"]
    same = effect.rates({"velocity": v, "level": f_c, "bristle": x}, {"stiffness": sigma})
    assert sp.simplify(sigma * same["bristle"].subs(x, f / sigma) - force_rate(v, f)) == 0
    assert CONTROLLERS["dahl"].parameters["stiffness"] is effect.parameters["stiffness"]


def test_the_simulated_bristle_follows_the_exact_solution():
    """Monotone motion of 20 bristle lengths: the kernel's friction against eq (9)."""
    body = Body(
        "prismatic",
        {"inertia": Value(0.1), "coulomb.level": Value(LEVEL), "presliding.stiffness": Value(1e5)},
        (EFFECTS["coulomb"], EFFECTS["presliding"]),
    )
    time = np.linspace(0.0, 0.05, 51)
    motion = sampled_motion(time, 1e-4 * (time / 0.05) ** 2)
    result = simulate(haptic_interface(body), duration=0.05, motion={"L": motion}, jit=False)
    expected = [exact(0.0, dx, stiffness=1e5) for dx in result["L"].values]
    assert np.abs(result["Z_M_friction"].values - expected).max() < 1e-4 * LEVEL

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


def test_eq_9_solves_eq_2_at_any_speed():
    """df/dx of eq (9) is eq (1) with alpha = 1, going up and going down: rate independent."""
    for s in (1, -1):
        start = sp.Symbol("start", real=True)
        step = f_c * s + (start - f_c * s) * sp.exp(-sigma / f_c * s * x)
        rate = force_rate(sp.S(s), step)  # at speed 1 along s: df/dt = s df/dx
        assert sp.simplify(rate - s * sp.diff(step, x)) == 0


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


def test_forward_euler_loses_its_bound_at_q_1_and_its_stability_at_q_2():
    """Eqs (3), (4): called backward Euler, it is forward Euler with pole 1 - q, q = T sigma v/f_c.

    From f = -f_c one step reaches (2 q - 1) f_c: twice the level at q = 1.5.
    """
    q = sp.Symbol("q", positive=True)
    step = f + T * force_rate(v, f)
    up = step.subs(sp.Abs(v), v).subs(v, q * f_c / (T * sigma))
    assert sp.simplify(sp.diff(up, f) - (1 - q)) == 0
    assert sp.simplify(up.subs(f, -f_c) - (2 * q - 1) * f_c) == 0


def test_backward_euler_never_leaves_its_level():
    """True backward Euler: (f + T sigma v)/(1 + T sigma abs(v)/f_c), within f_c."""
    new = sp.Symbol("new", real=True)
    (solved,) = sp.solve(sp.Eq(new, f + T * force_rate(v, new)), new)
    printed = (f + T * sigma * v) / (1 + T * sigma * sp.Abs(v) / f_c)
    assert sp.simplify(solved - printed) == 0
    up = printed.subs(sp.Abs(v), v)
    assert sp.simplify(up.subs(f, f_c) - f_c) == 0


def test_the_sign_of_the_velocity_instead_of_the_travel_turns_the_force_around():
    """Eq (9) with sgn(v_i): forward d1, back d2 > d1 in one sample, to first order in the travel.

    Printed minus exact = 2 sigma abs(dx) + 2 sigma d1 f/f_c; with sgn(dx) only the last remains.
    """
    e, d1, back = sp.symbols("epsilon d1 back", positive=True)

    def step(force, travel, s):
        return f_c * s + (force - f_c * s) * sp.exp(-sigma / f_c * travel)

    d2 = d1 + back  # dx = -back
    true = step(step(f, e * d1, 1), e * d2, -1)
    wrong, right = step(f, e * back, 1), step(f, e * back, -1)
    first = sp.diff(sp.expand(wrong - true), e).subs(e, 0)
    assert sp.simplify(first - (2 * sigma * back + 2 * sigma * d1 * f / f_c)) == 0
    rest = sp.diff(sp.expand(right - true), e).subs(e, 0)
    assert sp.simplify(rest - 2 * sigma * d1 * f / f_c) == 0


def test_dahl_friction_is_passive_with_the_energy_of_its_bristle():
    """f v = d/dt (f^2/(2 sigma)) + abs(v) f^2/f_c: storage and dissipation."""
    stored = f / sigma * force_rate(v, f)
    assert sp.simplify(f * v - stored - sp.Abs(v) * f**2 / f_c) == 0


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

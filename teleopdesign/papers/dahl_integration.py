"""The Dahl model, its Euler steps and its exact step over a travel: P27 to P32.

q = T sigma abs(v)/f_c throughout.
"""

from __future__ import annotations

import numpy as np
import sympy as sp

from ..blocks import Body, Value
from ..controllers import controller
from ..diagrams import haptic_interface
from ..simulate import Trajectory, simulate
from ._laws import dahl_rate, dahl_step
from ._proof import Correction, Equal, Grows, Holds, NotNegative, ProofStep, ProofSteps, proof
from ._statement import MAHVASH, Numbers, figure_near, numbers_of, shows

f, v, new = sp.symbols("f v f_next", real=True)
f_c, sigma, T, q, d, e = sp.symbols("f_c sigma T q d e", positive=True)
ABOVE, BELOW = sp.symbols("above below", nonnegative=True)  # f_c - f and f_c + f
INSIDE = (f_c - f, f_c + f)
LEVELS = {ABOVE: INSIDE[0], BELOW: INSIDE[1]}
FORWARD = f + T * dahl_rate(f, v, f_c, sigma)


def step_upwards(step: sp.Expr) -> sp.Expr:
    """The step at a speed v > 0 with T sigma v/f_c = q; the step at -v mirrors it in the origin."""
    return step.subs(v, q * f_c / (T * sigma))


@shows(27, MAHVASH, "eq (1)")
def general_exponent() -> ProofSteps:
    """The Dahl model with any exponent, also for forces outside of its level.

    formula: df/dx = sigma abs(1 - (f/f_c) sgn v)^alpha sgn(1 - (f/f_c) sgn v)
    printed: sigma (1 - (f/f_c) sgn v)^alpha, right only for abs(f) <= f_c or odd alpha
    """
    base = sp.Symbol("base", positive=True)  # 1 - (f/f_c) sgn v, positive inside
    alpha = sp.Symbol("alpha", positive=True)
    printed, safe = base**alpha, sp.Abs(base) ** alpha * sp.sign(base)
    outside, half = sp.Integer(-1), sp.Rational(1, 2)
    law = dahl_rate(f, sp.S(1), f_c, sigma)
    return proof(
        Equal("inside both are one", printed, safe),
        Equal("alpha = 1, moving up: the law of the package", law, sigma * (1 - f / f_c)),
        Holds("outside, alpha = 2: the print drives the force on outwards", outside**2, ">", 0),
        Holds("the safe form brings it back", sp.Abs(outside) ** 2 * sp.sign(outside), "<", 0),
        Holds("outside, alpha = 1/2: the print is not real", outside**half, "==", sp.I),
    )


@shows(28, MAHVASH, "eq (3)", how="refuted")
def called_backward_euler() -> Correction:
    """The printed step is forward Euler; true backward Euler is stable and keeps its level.

    formula: f_next = f + T sigma v (1 - (f/f_c) sgn v) is forward Euler;  backward: f_next = (f + T
        sigma v)/(1 + T sigma abs(v)/f_c)
    printed: eq (3) is called "backward Euler"
    """
    printed = f + T * sigma * v * (1 - f / f_c * sp.sign(v))
    implicit = sp.Eq(new, f + T * dahl_rate(new, v, f_c, sigma))
    (backward,) = sp.solve(implicit, new)
    shown = (f + T * sigma * v) / (1 + T * sigma * sp.Abs(v) / f_c)
    point = {f: 0, v: 1, T: 1, sigma: 1, f_c: 1}
    step = step_upwards(shown)
    return Correction(
        proof(
            Equal("the printed step takes the rate at the old force", printed, FORWARD),
            Holds("the backward step is another", printed.subs(point), "!=", backward.subs(point)),
        ),
        proof(
            Equal("backward Euler solved", backward, shown),
            Equal("its pole 1/(1 + q)", sp.diff(step, f), 1 / (1 + q)),
            NotNegative("is below 1", 1 - 1 / (1 + q), q / (1 + q), strictly=True),
            NotNegative("stays below f_c", f_c - step, ABOVE / (1 + q), LEVELS),
            NotNegative("and above -f_c", f_c + step, (BELOW + 2 * q * f_c) / (1 + q), LEVELS),
            assuming=INSIDE,
        ),
    )


@shows(29, MAHVASH, "eq (4)", how="refuted")
def pole_of_forward_euler() -> Correction:
    """Pole of the printed step, and the speed from which it is unstable.

    formula: pole 1 - q, q = T sigma abs(v)/f_c; unstable for q > 2
    printed: 1 - sigma abs(v)/f_c: T is missing; the unit circle is abs(z) = 1
    """
    step = step_upwards(FORWARD)
    slope = sp.diff(FORWARD.subs(v, d), f)
    point = {sigma: 1, d: 1, f_c: 1, T: 2}
    return Correction(
        proof(
            Holds(
                "without T the pole is another",
                (1 - sigma * d / f_c).subs(point),
                "!=",
                slope.subs(point),
            )
        ),
        proof(
            Equal("pole from the law", sp.diff(step, f), 1 - q),
            NotNegative("q = 2 + e: below -1", -1 - (1 - q).subs(q, 2 + e), e, strictly=True),
            Equal("q = 2: on the circle", (1 - q).subs(q, 2), -1),
            NotNegative(
                "q = 2 e/(1 + e) < 2: above -1",
                (1 - q).subs(q, 2 * e / (1 + e)) + 1,
                2 / (1 + e),
                strictly=True,
            ),
        ),
    )


@shows(30, MAHVASH, "after eq (4)")
def bound_of_forward_euler() -> ProofSteps:
    """The bound that passivity needs fails at half the speed at which the step diverges.

    formula: abs(f) <= f_c is kept iff q <= 1, v <= f_c/(T sigma) = lambda/T; from -f_c one step
        reaches (2 q - 1) f_c
    printed: "unstable at high velocity": stability ends at q = 2, the bound already at q = 1
    """
    step = step_upwards(FORWARD)
    slow = sp.Symbol("slow", nonnegative=True)  # 1 - q
    signs = {**LEVELS, slow: 1 - q}
    lowest = step.subs(f, -f_c)
    return proof(
        NotNegative("q <= 1: stays below f_c", f_c - step, slow * ABOVE, signs),
        NotNegative("and above -f_c", f_c + step, BELOW + q * ABOVE, signs),
        Equal("from -f_c", lowest, (2 * q - 1) * f_c),
        NotNegative(
            "q = 1 + e: beyond f_c", (lowest - f_c).subs(q, 1 + e), 2 * e * f_c, strictly=True
        ),
        Equal("q = 3/2, stable: twice the level", lowest.subs(q, sp.Rational(3, 2)), 2 * f_c),
        assuming=(*INSIDE, 1 - q),
    )


SHARE = sp.exp(-sigma * d / f_c)  # remaining share of the distance to the level after the travel d


def sampled_compensator() -> Numbers:
    """The package's sampled compensator, compared with the step of the proof at every sample."""
    positions = 1e-4 * np.array([0.0, 0.3, 0.9, 0.9, 0.5, -0.4, -3.0, 2.0, 2.0, 2.1])
    level, stiffness, period = 0.5, 5e3, 1e-3

    def held(t: np.ndarray) -> np.ndarray:
        sample = np.clip(np.round(t / period).astype(int), 0, len(positions) - 1)
        return np.asarray(positions[sample])

    law = controller("dahl", {"level": level, "stiffness": stiffness})
    forces = simulate(
        haptic_interface(Body("prismatic", {"inertia": Value(1.0)}), cancellation=law),
        duration=period * (len(positions) - 1),
        motion={"L": Trajectory(held, np.zeros_like, np.zeros_like)},
        step=period,
        jit=False,
    )["R_MBC"].values
    force, worst = 0.0, 0.0
    for dx, sampled in zip(np.diff(positions), forces[1:], strict=True):
        step = dahl_step(f, d, 1 if dx >= 0 else -1, f_c, sigma)
        force = float(step.subs({f: force, d: abs(dx), f_c: level, sigma: stiffness}))
        worst = max(worst, abs(float(sampled) - force))
    # rounding of doubles
    return numbers_of(figure_near("largest difference", worst, 0.0, 1e-13, "N"))


@shows(31, MAHVASH, "eq (9)", numbers=sampled_compensator)
def exact_step() -> ProofSteps:
    """The exact step, for any speed profile without a reversal within the sample. It keeps abs(f)
    <= f_c for every sequence of positions and never diverges.

    formula: f_next = f_c s + (f - f_c s) exp(-(sigma/f_c) abs(dx)),  s = sgn(dx)
    """
    steps: list[ProofStep] = []
    for s in (1, -1):
        step = dahl_step(f, d, s, f_c, sigma)
        steps += [
            Equal(
                f"the law stepped exactly is eq (9), s = {s:+d}",
                step,
                f_c * s + (f - f_c * s) * SHARE,
            ),
            Equal(
                "it solves the law over the travel, so at any speed",
                sp.diff(step, d),
                dahl_rate(step, sp.S(s), f_c, sigma),
            ),
            Equal(
                f"two parts in direction {s:+d} are the whole",
                dahl_step(step, e, s, f_c, sigma),
                dahl_step(f, d + e, s, f_c, sigma),
            ),
            Equal("differences between two starts shrink by", sp.diff(step, f), SHARE),
        ]
    up = dahl_step(f, d, 1, f_c, sigma)
    rest = sp.Symbol("rest", nonnegative=True)
    return proof(
        steps,
        Grows("which is at most 1", 1 - SHARE, d, sigma / f_c * SHARE),
        NotNegative("stays below f_c", f_c - up, ABOVE * SHARE, LEVELS),
        NotNegative(
            "and above -f_c; downwards is the point mirror",
            f_c + up,
            BELOW * SHARE + 2 * f_c * rest,
            {**LEVELS, rest: 1 - SHARE},
        ),
        assuming=INSIDE,
    )


@shows(32, MAHVASH, "eq (9)", how="refuted")
def sign_of_the_travel() -> Correction:
    """Motion forward by d1, then back by more within one sample. With the sign of the old velocity
    the force changes in the wrong direction; with the sign of the travel the error is bounded.

    formula: s = sgn(x_next - x): error within a sample that turns at most 2 sigma d1, d1 <= abs(a)
        T^2/8; travel 0 keeps the force
    printed: sgn(v_i), the velocity at the old sample
    """
    back, small, t1, acc, early = sp.symbols("back small t_1 a early", positive=True)

    def step(force: sp.Expr, travel: sp.Expr, s: int) -> sp.Expr:
        return dahl_step(force, travel, s, f_c, sigma)

    true = step(step(f, small * d, 1), small * (d + back), -1)
    wrong, right = step(f, small * back, 1), step(f, small * back, -1)
    error = (right - true).subs(small, 1)
    way = sp.exp(-sigma * back / f_c)
    rest, over, one = sp.symbols("rest over one", nonnegative=True)
    signs = {**LEVELS, rest: 1 - SHARE, one: 1 - way, over: SHARE - 1 + sigma * d / f_c}
    return Correction(
        _sign_of_the_old_velocity(true, wrong, back, small),
        proof(
            Equal(
                "corrected, to first order",
                _first_order(right - true, small),
                2 * sigma * d * f / f_c,
            ),
            Grows("1 - exp(-sigma d1/f_c) >= 0", 1 - SHARE, d, sigma / f_c * SHARE),
            Grows("likewise for the travel", 1 - way, back, sigma / f_c * way),
            Grows(
                "exp(-sigma d1/f_c) >= 1 - sigma d1/f_c",
                SHARE - 1 + sigma * d / f_c,
                d,
                sigma / f_c * rest,
                {rest: 1 - SHARE},
            ),
            NotNegative(
                "error <= 2 sigma d1",
                2 * sigma * d - error,
                2 * f_c * over + rest * (BELOW * one + ABOVE * (1 + way * SHARE)),
                signs,
            ),
            NotNegative(
                "error >= -2 sigma d1",
                2 * sigma * d + error,
                2 * f_c * over + rest * (BELOW * (1 + way) + ABOVE * (one + way * rest)),
                signs,
            ),
            NotNegative(
                "the turn comes in the first half of the sample: d1 = a t_1^2/2 <= a T^2/8",
                (acc * T**2 / 8 - acc * t1**2 / 2).subs(T, 2 * (t1 + early)),
                acc * (early**2 + 2 * early * t1) / 2,
            ),
            Equal("travel 0 keeps the force", step(f, sp.S(0), -1), f),
            assuming=INSIDE,
        ),
    )


def _sign_of_the_old_velocity(
    true: sp.Expr, wrong: sp.Expr, back: sp.Symbol, small: sp.Symbol
) -> ProofSteps:
    """With the old velocity's sign the force moves the wrong way, to first order in `small`."""
    falls, rises = _first_order(true, small), _first_order(wrong, small)
    return proof(
        Equal(
            "printed less true, to first order: 2 sigma abs(dx) too much",
            _first_order(wrong - true, small),
            2 * sigma * back + 2 * sigma * d * f / f_c,
        ),
        Equal("at f = 0 the true force falls", falls.subs(f, 0), -sigma * back),
        Equal("the printed one rises", rises.subs(f, 0), sigma * back),
    )


def _first_order(error: sp.Expr, small: sp.Symbol) -> sp.Expr:
    return sp.diff(error, small).subs(small, 0)

"""The Dahl model and its Euler steps: P27 to P30. q = T sigma abs(v)/f_c throughout."""

from __future__ import annotations

import sympy as sp

from ._laws import dahl_rate
from ._proof import Correction, Equal, Holds, NotNegative, ProofSteps, proof
from ._statement import MAHVASH, shows

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

"""Compensation of friction with presliding, an elastic displacement before sliding: P43 to P46.

The plant is Dahl(sigma_p, f_C), the compensator Dahl(sigma_D, f_D) on the same position. The pair
takes in (p - d) v, with p and d their forces.
"""

from __future__ import annotations

import sympy as sp

from ._laws import bristle_force, bristle_rate, dahl_rate, stribeck_level, viscous
from ._proof import Equal, Grows, Limit, NotNegative, ProofStep, ProofSteps, proof
from ._statement import DERIVED, shows
from .dahl_loop import A, loop_energy

p, d = sp.symbols("p d", real=True)
sP, sD, fC, fD, w, g = sp.symbols("sigma_p sigma_D f_C f_D w g", positive=True)
gap = sp.Symbol("gap", positive=True)  # sigma_p - sigma_D
SOFTER, LOWER = sp.symbols("softer lower", nonnegative=True)
ALPHA, BETA = (1 + g * sD) / sP, (g * sP - 1) / sD
STORED = ALPHA * p**2 / 2 + BETA * d**2 / 2 - g * p * d
LEVELS = fC - fD
RATIOS = sP**2 / fC - sD**2 / fD
CHOSEN = {g: 2 / gap, sP: sD + gap}


def rate(stored: sp.Expr, direction: int) -> sp.Expr:
    """Rate of a stored energy at speed w in one direction, by the laws of plant and compensator."""
    v = direction * w
    return sp.diff(stored, p) * dahl_rate(p, v, fC, sP) + sp.diff(stored, d) * dahl_rate(
        d, v, fD, sD
    )


def dissipation(level: sp.Expr) -> sp.Matrix:
    """Q of supply - dV/dt = abs(v) (p d) Q (p d)^T, for that friction level of the plant."""
    m, n = sP / level, sD / fD
    side = -g * (m + n) / 2
    return sp.Matrix([[ALPHA * m, side], [side, BETA * n]])


def stored_and_lost(level: sp.Expr) -> list[ProofStep]:
    """V balances the supply with Q, V > 0, and det Q is the product of two factors."""
    q = dissipation(level)
    form = (sp.Matrix([[p, d]]) * q * sp.Matrix([p, d]))[0]
    factors = (level - fD) * (sP**2 / level - sD**2 / fD)
    steps: list[ProofStep] = [
        Equal(
            f"supply less dV/dt is w (p d) Q (p d)^T at v = {way:+d} w",
            (p - d) * way * w - rate(STORED, way).subs(fC, level),
            w * form,
        )
        for way in (1, -1)
    ]
    return [
        *steps,
        NotNegative("V > 0: its first entry", ALPHA, ALPHA, strictly=True),
        NotNegative(
            "V > 0: its determinant at g = 2/(sigma_p - sigma_D), sigma_p > sigma_D",
            sp.hessian(STORED, (p, d)).det().subs(CHOSEN),
            1 / (sD * (sD + gap)),
            strictly=True,
        ),
        NotNegative("Q >= 0: its first entry", q[0, 0], q[0, 0], strictly=True),
        Equal(
            "Q >= 0: its determinant is a product of the two conditions",
            q.det().subs(CHOSEN),
            (factors / (level * fD * gap**2)).subs(CHOSEN),
        ),
    ]


def small_cycles(level: sp.Expr, stiffness: sp.Expr) -> sp.Expr:
    """Energy of a cycle over A^3 in the limit of small amplitude A, from the exact loop."""
    return sp.limit(loop_energy(level, stiffness) / A**3, A, 0, "+")


@shows(43, DERIVED, "extends Mahvash 2006, section IV-B")
def matched_bristles() -> ProofSteps:
    """Dahl friction with a Dahl compensator on the same position: necessary and sufficient
    condition for a passive pair.

    formula: passive iff f_D <= f_C and sigma_D^2/f_D <= sigma_p^2/f_C (then sigma_D <= sigma_p)
    printed: the proof of the paper supposes ideal Coulomb friction at the measured coordinate
    """
    signs = {LOWER: LEVELS, SOFTER: RATIOS}
    size = sp.Symbol("size", nonnegative=True)  # abs(p - d)
    shrink = dahl_rate(p, w, fC, sP) - dahl_rate(d, w, fC, sP)
    return proof(
        stored_and_lost(fC),
        NotNegative("which is not negative", LEVELS * RATIOS, LOWER * SOFTER, signs),
        NotNegative(
            "both conditions together: sigma_p^2 >= sigma_D^2",
            sP**2 - sD**2,
            fC * SOFTER + sD**2 * LOWER / fD,
            signs,
        ),
        Equal(
            "sigma_p = sigma_D leaves f_D = f_C: p - d shrinks at the rate abs(v)/lambda, so "
            "V = lambda abs(p - d) loses abs(v) abs(p - d)",
            shrink * fC / sP,
            -w * (p - d),
        ),
        [
            NotNegative(
                f"which covers any supply, sign {way:+d}",
                size * w + way * size * w,
                size * w * (1 + way),
            )
            for way in (1, -1)
        ],
        Equal(
            "necessary: small cycles take in (4/3) A^3 (sigma_p^2/f_C - sigma_D^2/f_D)",
            small_cycles(fC, sP) - small_cycles(fD, sD),
            sp.Rational(4, 3) * RATIOS,
        ),
        Limit(
            "necessary: large cycles take in 4 A f_C of the plant and give 4 A f_D",
            loop_energy(sp.S(1), sp.S(1)) / A,
            A,
            sp.oo,
            sp.S(4),
        ),
        assuming=[LEVELS, RATIOS],
    )


@shows(44, DERIVED, "extends P43")
def varying_level() -> ProofSteps:
    """The friction level of the plant may vary in any way between F_min and F_max (speed, position,
    load, drift): compensate the lowest level that can occur.

    formula: sufficient: f_D <= F_min and sigma_D^2/f_D <= sigma_p^2/F_max
    """
    level, least, most = sp.symbols("F F_min F_max", positive=True)
    up, under = sp.symbols("up under", nonnegative=True)
    low, soft = least - fD, sP**2 / most - sD**2 / fD
    signs = {LOWER: low, SOFTER: soft, up: level - least, under: most - level}
    return proof(
        stored_and_lost(level),  # g does not depend on the level: one V for all levels
        NotNegative("first factor at any level", level - fD, up + LOWER, signs),
        NotNegative(
            "second factor at any level",
            sP**2 / level - sD**2 / fD,
            SOFTER + sP**2 * under / (level * most),
            signs,
        ),
        assuming=[low, soft, level - least, most - level],
    )


@shows(45, DERIVED, "LuGre; Barabanov, Ortega, IEEE TAC 45 (2000) 830")
def bristle_damping() -> ProofSteps:
    """LuGre friction: the effect of bristle damping, and the condition for passivity by itself with
    the energy of the bristle as storage.

    formula: constant level: sigma_1 only dissipates;  level F_C..F_S: passive if sigma_2 >= sigma_1
        (F_S/F_C - 1)
    assumes: that the condition is also necessary is theirs and is not shown here
    """
    s0, s1, s2, extra, scale, level, FS = sp.symbols(
        "sigma_0 sigma_1 sigma_2 F_SC v_S g F_S", positive=True
    )
    force = sp.Symbol("y", real=True)  # sigma_0 z, moving up; down is the point mirror
    rate_ = bristle_rate(force / s0, w, level, s0)
    friction = bristle_force(force / s0, w, level, s0, s1) + viscous(w, s2)
    lost = friction * w - force * rate_
    inside, above, enough, one = sp.symbols("inside above enough one", nonnegative=True)
    margin = s2 - s1 * (FS / fC - 1)
    signs = {inside: FS - force, above: level - fC, enough: margin}
    bell = sp.exp(-((w / scale) ** 2))
    steepest = stribeck_level(w, fC, extra, scale)
    below = {inside: fC - force}
    return proof(
        NotNegative(
            "constant level f_C: the damping's power",
            s1 * rate_.subs(level, fC) * w,
            s1 * w**2 * inside / fC,
            below,
        ),
        Grows("1 - exp(-(v/v_S)^2) >= 0", 1 - bell, w, 2 * w / scale**2 * bell),
        NotNegative(
            "Stribeck: never above F_S, so abs(sigma_0 z) <= F_S is kept",
            fC + extra - steepest,
            extra * one,
            {one: 1 - bell},
        ),
        NotNegative("and never below F_C", steepest - fC, extra * bell),
        NotNegative(
            "supply less the rate of sigma_0 z^2/2",
            lost,
            w * force**2 / level + w**2 * (enough + s1 * (FS * above + fC * inside) / (fC * level)),
            signs,
        ),
        assuming=[FS - force, level - fC, margin, fC - force],
    )


@shows(46, DERIVED, "consequence of P43")
def stiff_compensator() -> ProofSteps:
    """A compensator stiffer than the plant releases energy in small motion, even with a level far
    below that of the plant. A lower sigma_D stops the release, a lower f_D increases it.

    formula: small cycles give out (4/3) A^3 (sigma_D^2/f_D - sigma_p^2/f_C)
    """
    released = small_cycles(fD, sD) - small_cycles(fC, sP)
    stiffer, share = sp.symbols("stiffer share", positive=True)
    return proof(
        Equal("per A^3", released, -sp.Rational(4, 3) * RATIOS),
        NotNegative(
            "sigma_D > sigma_p and f_D < f_C",
            released.subs({sD: sP + stiffer, fC: fD + share}),
            sp.Rational(4, 3)
            * (2 * sP * stiffer * (fD + share) + stiffer**2 * (fD + share) + sP**2 * share)
            / (fD * (fD + share)),
            strictly=True,
        ),
        NotNegative(
            "falls with lower sigma_D",
            sp.diff(released, sD),
            sp.Rational(8, 3) * sD / fD,
            strictly=True,
        ),
        NotNegative(
            "rises with lower f_D",
            -sp.diff(released, fD),
            sp.Rational(4, 3) * sD**2 / fD**2,
            strictly=True,
        ),
    )

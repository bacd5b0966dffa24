"""Describing functions in closed form, on symbols or numbers: P16, P17, P18.

Relative to position x = A sin(omega t): phasor of the first harmonic of the force that opposes the
motion, over A; a spring is real, friction +j. Proved in `papers.describing_functions`.
"""

from __future__ import annotations

import sympy as sp


def coulomb(level: sp.Expr | float, amplitude: sp.Expr | float) -> sp.Expr:
    """P16: Coulomb friction, j 4 F_C/(pi A), at any frequency."""
    return sp.I * 4 * level / (sp.pi * amplitude)


def smoothed_coulomb(
    level: sp.Expr | float,
    smoothing_velocity: sp.Expr | float,
    amplitude: sp.Expr | float,
    velocity: sp.Expr | float,
) -> sp.Expr:
    """P17: smoothed Coulomb friction F_C v/(a + abs(v)); velocity: amplitude V = omega A."""
    r = sp.sympify(smoothing_velocity) / velocity
    below, at, above = reciprocals(r)
    return coulomb(level, amplitude) * sp.Piecewise(
        (smoothed_share(r, below), r < 1),
        (smoothed_share(r, at), sp.Eq(r, 1)),
        (smoothed_share(r, above), True),
    )


def smoothed_share(r: sp.Expr, reciprocal: sp.Expr | float) -> sp.Expr:
    """Ratio of first harmonics, smoothed to Coulomb friction, r = a/V; see `reciprocals`."""
    return 1 - sp.pi * r / 2 + r**2 * reciprocal


def reciprocals(r: sp.Expr) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """J, the integral of 1/(r + cos phi) over a quarter turn, for r < 1, r = 1 and r > 1."""
    below = sp.acosh(1 / r) / sp.sqrt(1 - r**2)
    return below, sp.S(1), sp.acos(1 / r) / sp.sqrt(r**2 - 1)


def dahl(level: sp.Expr | float, stiffness: sp.Expr | float, amplitude: sp.Expr | float) -> sp.Expr:
    """P18: Dahl friction, from a spring in small motion to Coulomb friction in large motion.

    With u = sigma A/f bristle lengths, the spring part decays only as 1/sqrt(u).
    """
    u = sp.sympify(stiffness) * amplitude / level
    return (dahl_spring(level, u) + sp.I * dahl_friction(level, u)) / amplitude


def dahl_spring(level: sp.Expr | float, u: sp.Expr | float) -> sp.Expr:
    """First harmonic of Dahl friction in phase with position, unit of the level."""
    return 2 * level * sp.besseli(1, u) / sp.cosh(u)


def dahl_friction(level: sp.Expr | float, u: sp.Expr | float) -> sp.Expr:
    """First harmonic of Dahl friction in phase with velocity, unit of the level."""
    return 4 * level / sp.pi * (1 - sp.tanh(u) / u)

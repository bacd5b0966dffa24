"""The excess of damping of an impedance, with exact bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from ...derive.polynomials import X, even_part, has_positive_root, positive_roots, value
from .conditions import is_shown
from .family import family_of_impedance
from .impedance import Impedance, MotionKind, exact, impedance
from .signs import Signs


def describe_equality(z: Impedance, margin: Excess) -> str:
    """Text that says where Re Z = 0 on the axis, decided exactly; "" where nowhere."""
    real, size = _real_part(z)
    if real.is_zero:
        return "at every frequency: it stores, and loses nothing"
    if real.eval(0) == 0 or has_positive_root(real.sqf_part()):
        return f"at {margin.frequency:.4g} rad/s"
    return "in the limit of high frequency" if real.degree() < size.degree() else ""


@dataclass(frozen=True)
class Excess:
    """Excess of passivity: the largest c for which Z - c is still passive; negative: a shortage.

    lower, upper: exact bounds of c; both -inf where no damping at the port helps (a pole that
        grows, a double pole on the axis)
    frequency: rad/s, at which Re Z is smallest; inf where this is the limit of high frequency
    """

    lower: Fraction | float
    upper: Fraction | float
    frequency: float

    def __float__(self) -> float:
        return float(self.lower)


def damping_excess(system: Any, *, motion: MotionKind = "velocity") -> Excess:
    """Excess of damping of an impedance, N s/m; < 0: the damping that the impedance lacks.

    This is the infimum of Re Z over frequency (the index of input passivity, with the velocity as
    input), or -inf. The exact test verifies its bounds. They differ by 1e-12 of its size; where the
    test does not confirm bounds so narrow, by up to 2e-6.

    system, motion: see `impedance`;  raises ModelError: no impedance
    """
    z = impedance(system, motion=motion)
    at, lowest = _infimum(*_real_part(z))
    lower, upper = _verify_bounds(z, lowest)
    return Excess(lower, upper, float(np.sqrt(at)))


def _infimum(real: sp.Poly, size: sp.Poly) -> tuple[float, float]:
    """(x, value) at the infimum of real/size over x >= 0, in floating point.

    x is inf where the infimum is the limit of high frequency.
    """
    slope = real.diff(X) * size - real * size.diff(X)
    extremes = []
    for x in (Fraction(0), *positive_roots(slope)):
        below = value(size, x)
        if below != 0:
            extremes.append((float(x), float(value(real, x) / below)))
    if real.degree() <= size.degree():
        limit = real.LC() / size.LC() if real.degree() == size.degree() else 0
        extremes.append((float("inf"), float(limit)))
    elif real.LC() < 0:
        extremes.append((float("inf"), float("-inf")))
    return min(extremes, key=lambda pair: pair[1]) if extremes else (0.0, float("-inf"))


def _verify_bounds(z: Impedance, lowest: float) -> tuple[Fraction | float, Fraction | float]:
    """Bounds c- and c+ near `lowest`, by the exact test: Z - c- is passive, Z - c+ is not.

    Both are -inf where no such bounds are close to `lowest`; c+ is inf where it alone is not.
    """
    if not np.isfinite(lowest):
        return float("-inf"), float("-inf")
    middle = Fraction(str(exact(lowest)))
    is_below = is_passive(z, middle)
    for relative in (1e-12, 1e-9, 1e-6):
        step = abs(middle) * Fraction(relative) or Fraction(relative) ** 2
        other = middle + step if is_below else middle - step
        if is_passive(z, other) != is_below:
            return min(middle, other), max(middle, other)
    return (middle, float("inf")) if is_below else (float("-inf"), float("-inf"))


def is_passive(z: Impedance, less: Fraction = Fraction(0)) -> bool:
    """Whether Z - c is shown to be passive;  less: c, N s/m."""
    other = replace(z, p=z.p - sp.Rational(less) * z.q)
    return not z.unseen and is_shown(Signs(()), family_of_impedance(other), "passive")


def _real_part(z: Impedance) -> tuple[sp.Poly, sp.Poly]:
    """Re Z(j w) as a ratio of coprime polynomials in x = w^2."""
    real, size = even_part(z.p, z.q), even_part(z.q, z.q)
    common = sp.gcd(real, size)
    return real.quo(common), size.quo(common)

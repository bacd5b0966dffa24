"""The axis with dead times, to many digits, and its ends, where a sweep shows nothing.

Towards s = 0 two dead times leave differences of numbers that agree in tens of digits, so the
inequality is evaluated with many digits. Far out each dead time has every phase, whatever the
frequency: phases are drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import mpmath
import numpy as np

from ..search.points import zeros_and_poles
from .family import Family

#: decimal digits, and decades beyond the roots and dead times at either end
_DIGITS, _DECADES = 200, (1, 2, 4, 6, 9)
#: phases that are drawn far out, at each decade
_DRAWN = 40
#: size of a negative margin, over the sizes of its terms, that is rounding of the margin's zero
_ROUNDING = 1e-60


def fails_at_ends(family: Family, claim: str) -> tuple[str, float] | None:
    """Where the inequality of a claim fails at an end of the axis: in words, and at which Hz."""
    zeros, poles = zeros_and_poles(family)
    sizes = np.abs([r for r in (*zeros, *poles) if r != 0] or [1.0])
    times = [float(t) for t in family.times.values()]
    slow, fast = min(sizes.min(), 1 / max(times)), max(sizes.max(), 1 / min(times))
    rng = np.random.default_rng(0)
    for decade in _DECADES:
        low = float(slow) / 10**decade / (2 * np.pi)
        if not holds_at(family, low, claim):
            return "in the limit of low frequency", low
    with mpmath.workdps(_DIGITS):
        for decade in _DECADES:
            w = mpmath.mpf(float(fast)) * 10**decade
            for _ in range(_DRAWN):
                late = [mpmath.expj(float(x)) for x in rng.uniform(0, 2 * np.pi, len(times))]
                if not _holds(_value_at(family, w, late), claim):
                    return "in the limit of high frequency", float(w) / (2 * np.pi)
    return None


def holds_at(family: Family, frequency: float, claim: str) -> bool:
    """Whether the inequality of a claim holds at a frequency, Hz, by many digits; so at a pole."""
    with mpmath.workdps(_DIGITS):
        w = 2 * mpmath.pi * mpmath.mpf(frequency)
        times = (mpmath.mpf(int(t.p)) / int(t.q) for t in family.times.values())
        try:
            z = _value_at(family, w, [mpmath.expj(-w * t) for t in times])
        except ZeroDivisionError:
            return True
        return _holds(z, claim)


def _value_at(family: Family, w: mpmath.mpf, late: Sequence[mpmath.mpc]) -> list[list[mpmath.mpc]]:
    """Z at s = j w with these values of e^(-s T)."""

    def value(p: Any) -> mpmath.mpc:
        total = mpmath.mpc(0)
        for powers, c in p.items():
            term = mpmath.mpf(int(c.numerator)) / int(c.denominator) * mpmath.mpc(0, w) ** powers[0]
            for factor, power in zip(late, powers[1:], strict=True):
                term *= factor**power
            total += term
        return total

    below = value(family.d)
    return [[value(e) / below for e in row] for row in family.n]


def _holds(z: list[list[mpmath.mpc]], claim: str) -> bool:
    """Whether the inequality of the claim holds for a matrix on the axis."""
    n = len(z)
    if claim == "absolutely stable":
        r1, r2, loop = z[0][0].real, z[1][1].real, z[0][1] * z[1][0]
        size = abs(r1 * r2) + abs(loop)
        margin = 2 * r1 * r2 - loop.real - abs(loop)
        return bool(min(r1, r2) >= 0 and margin >= -_ROUNDING * size)
    h = [[z[i][j] + mpmath.conj(z[j][i]) for j in range(n)] for i in range(n)]
    size = max(abs(e) for row in z for e in row)
    for number in range(1, n + 1):
        for chosen in combinations(range(n), number):
            minor = mpmath.det(mpmath.matrix([[h[i][j] for j in chosen] for i in chosen]))
            if minor.real < -_ROUNDING * size**number:
                return False
    return True

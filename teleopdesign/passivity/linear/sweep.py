"""The least margin of a family over frequency: numerical, no proof.

Nonnegative margins on the axis are necessary and not sufficient: they show neither poles in the
right half plane nor residues at poles on the axis.

At the ends of the axis and beside its poles a sweep shows nothing. Towards s = 0 two dead times
leave differences of numbers that agree in tens of digits, so the inequality is evaluated with many
digits. Far out each dead time has every phase, whatever the frequency: phases are drawn. A pole on
the axis whose residue a dead time turns by a hair makes the inequality fail in a hair beside it.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import Any

import mpmath
import numpy as np

from ...derive.polynomials import as_poly, roots_of
from ...realise.lti import S
from .family import Family
from .signs import degree

#: places across a resonance, in half widths from its frequency: the real part of an entry changes
#: its sign within the first half width
_ACROSS = (-30.0, -10.0, -3.0, -1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0, 3.0, 10.0, 30.0)
#: margins of matrices Z, (m, n, n) -> (m,)
SweptMargin = Callable[[np.ndarray], np.ndarray]


def passive_margin(z: np.ndarray) -> np.ndarray:
    """Smallest eigenvalue of the Hermitian part of each matrix, (n,); NaN where z is not finite.

    z: (n, k, k), on the axis or in the right half plane
    """
    finite = np.isfinite(z).all(axis=(1, 2))
    margin = np.full(len(z), np.nan)
    margin[finite] = np.linalg.eigvalsh((z[finite] + z[finite].conj().swapaxes(1, 2)) / 2)[:, 0]
    return margin


def stable_margin(z: np.ndarray) -> np.ndarray:
    """Llewellyn's stability parameter minus 1 of each matrix, (n,); z: (n, 2, 2), on the axis.

    inf where z12 z21 = 0;  -inf where Re z11 < 0 or Re z22 < 0
    """
    r1, r2, loop = z[:, 0, 0].real, z[:, 1, 1].real, z[:, 0, 1] * z[:, 1, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        margin = (2 * r1 * r2 - loop.real) / np.abs(loop) - 1
    margin = np.where(loop == 0, np.inf, margin)
    return np.where((r1 < 0) | (r2 < 0), -np.inf, margin)


def margin_of(claim: str) -> SweptMargin:
    """The margin that a claim asks for: "passive" in N s/m, "absolutely stable" without unit."""
    return stable_margin if claim == "absolutely stable" else passive_margin


def least_over(
    margin: Callable[[np.ndarray], np.ndarray], grid: np.ndarray, *, rounds: int, points: int
) -> tuple[float, float, np.ndarray]:
    """The frequency of the least margin, that margin, and the margins on the grid.

    margin: of frequencies, NaN where there is none;  grid: frequencies, in order
    rounds, points: of finer grids beside the least margin
    """
    values = margin(grid)
    first = np.where(np.isnan(values), np.inf, values)
    k = int(np.argmin(first))
    at, least, beside = float(grid[k]), float(first[k]), grid
    for _ in range(rounds):
        beside = np.geomspace(beside[max(k - 1, 0)], beside[min(k + 1, len(beside) - 1)], points)
        finer = margin(beside)
        finer = np.where(np.isnan(finer), np.inf, finer)
        k = int(np.argmin(finer))
        if finer[k] <= least:
            at, least = float(beside[k]), float(finer[k])
    return at, least, values


#: damping of a pole, over its frequency, that double precision hardly resolves
_NO_WIDTH = 1e-12
#: decades by which the inequality is evaluated closer and closer to a pole without width
_BESIDE = (2, 4, 6, 8, 10, 12, 16, 20, 30, 40)
#: decimal digits, and decades beyond the roots and dead times at either end
_DIGITS, _DECADES = 200, (1, 2, 4, 6, 9)
#: phases that are drawn far out, at each decade
_DRAWN = 40
#: size of a negative margin, over the sizes of its terms, that is rounding of the margin's zero
_ROUNDING = 1e-60


def fails_in_a_limit(family: Family, claim: str) -> tuple[str, float] | None:
    """Where the inequality of a claim fails at an end of the axis or beside one of its poles.

    returns: in words, and at which Hz
    """
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
                if not _holds(family.precisely(mpmath.mpc(0, w), late), claim):
                    return "in the limit of high frequency", float(w) / (2 * np.pi)
        for pole in _poles_at_axis(family, poles):
            for apart in (side * mpmath.mpf(10) ** -k for k in _BESIDE for side in (-1, 1)):
                at = pole * (1 + apart)
                if not _holds(family.precisely(mpmath.mpc(0, at)), claim):
                    hertz = float(at / (2 * mpmath.pi))
                    return f"beside the pole at {hertz:.4g} Hz", hertz
    return None


def _poles_at_axis(family: Family, poles: np.ndarray) -> list[mpmath.mpf]:
    """Frequencies, rad/s, of the poles that have no width in double precision, by many digits."""
    near = np.abs(poles.real) <= _NO_WIDTH * np.abs(poles)
    if not np.any(near & (poles.imag > 0)):
        return []
    parts = (as_poly(q, S).sqf_part() for q in _parts(family.d) if degree(q))
    pairs = (r.as_real_imag() for p in parts for r in p.nroots(n=60))
    return [mpmath.mpf(w) for a, w in pairs if w > 0 and abs(a) <= _NO_WIDTH * w]


def holds_at(family: Family, frequency: float, claim: str) -> bool:
    """Whether the inequality of a claim holds at a frequency, Hz, by many digits; so at a pole."""
    with mpmath.workdps(_DIGITS):
        try:
            z = family.precisely(mpmath.mpc(0, 2 * mpmath.pi * frequency))
        except ZeroDivisionError:
            return True
        return _holds(z, claim)


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


def zeros_and_poles(family: Family) -> tuple[np.ndarray, np.ndarray]:
    """Zeros and poles of the parts of all entries, one part for each dead time; without values."""
    above, below = [np.zeros(0)], [np.zeros(0)]
    whole = _parts(family.d)
    for row in family.n:
        for entry in row:
            for p in _parts(entry):
                for q in whole:
                    top, bottom = p.cancel(q)
                    above.append(roots_of(top))
                    below.append(roots_of(bottom))
    return np.concatenate(above), np.concatenate(below)


def _parts(p: Any) -> list[Any]:
    """Coefficients of the powers of dead times, polynomials in s alone."""
    made: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
    for k, c in p.items():
        made.setdefault(k[1:], {})[(k[0], *(0 for _ in k[1:]))] = c
    return [p.ring(part) for part in made.values()]


def resonances(family: Family) -> np.ndarray:
    """Frequencies across the width of each resonance, Hz, (n,): a grid alone may miss one.

    A pole on the axis has no width: closer and closer to it instead.
    """
    _, poles = zeros_and_poles(family)
    wide = poles.real < -_NO_WIDTH * np.abs(poles)
    apart = [side * 10.0**-k for k in _BESIDE[:5] for side in (-1, 1)]
    across = poles[wide].imag[:, None] + poles[wide].real[:, None] * np.array(_ACROSS)
    beside = np.abs(poles[~wide])[:, None] * (1.0 + np.array(apart))
    f = np.concatenate([across.ravel(), beside.ravel()]) / (2 * np.pi)
    return np.asarray(f[(f > 0) & np.isfinite(f)])

"""A loop gain as a ratio of sums of polynomials in s, each delayed.

Its bounds between two frequencies miss no crossing:

    |p_0| - |p_1| - ...  <=  |sum_k p_k(j w) e^(-j w T_k)|  <=  |p_0| + |p_1| + ...

The p_k change slowly, so that a grid with their roots follows them. Late terms turn as often as
they like between two points of it: a ripple there is followed by halving, where it may matter.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..derive.all_states import all_states
from ..derive.linear_rows import read_late_ratios
from ..derive.polynomials import RING, cross, roots_of
from ..diagrams import Diagram
from .late_zeros import Terms, coefficient, corners_of, degree_of, describe_growth, terms_of


@dataclass(frozen=True)
class LateRatio:
    """above/below; each a mapping from dead time (s) to coefficients in s, highest power first.

    fault: why a loop of this gain has no margins, whatever its gain; "" for none
    """

    above: Terms
    below: Terms
    fault: str = ""

    @property
    def closed(self) -> Terms:
        """above + below, which is zero at the poles of the closed loop."""
        times = sorted({*self.above, *self.below})
        none = np.zeros(1)
        sums = {t: np.polyadd(self.above.get(t, none), self.below.get(t, none)) for t in times}
        return {t: p for t, p in ((t, np.trim_zeros(p, "f")) for t, p in sums.items()) if len(p)}

    def fades(self) -> bool:
        """Whether the magnitude is below 1 at all high frequencies, for any dead times."""
        degree = degree_of(self.below)
        if degree_of(self.above) > degree:
            return False
        first, *others = (abs(coefficient(p, degree)) for p in self.below.values())
        return sum(abs(coefficient(p, degree)) for p in self.above.values()) < first - sum(others)

    def corners(self) -> np.ndarray:
        """Magnitudes of the roots of all polynomials, and points across resonances, rad/s."""
        return corners_of(self.above, self.below, self.closed)


def count_loop(diagram: Diagram, controller: str, *, speed: float) -> LateRatio:
    """The gain of a linear diagram's loop, with the modes that the loop does not see.

    With a factor g at the output of the controller, the determinant of all equations is d + g n.
    The loop gain is n/d, and common factors of n and d are modes that the loop does not change.

    raises ModelError: the wiring does not determine the loop
    """
    factor = sp.Symbol("factor")
    states = all_states(diagram, gains={controller: factor}, speed=speed)
    whole = states.determinant()
    place = states.ring.symbols.index(factor)
    sides = [states.ring({k: c for k, c in whole.items() if k[place] == power}) for power in (0, 1)]
    below, above = sides[0], sides[1].exquo(states.ring.gens[place]) if sides[1] else sides[1]
    if not below:
        raise ModelError(f"{diagram.name}: the wiring does not determine the loop of {controller}")
    return _count_modes(above, below, states.times)


def loop_as_written(gain: sp.Expr) -> LateRatio:
    """A loop by its gain alone, in `S` and e^(-s T), without states that the gain does not show.

    raises ModelError: it is no ratio of polynomials in s and dead times
    """
    ((above, below),), times = read_late_ratios([gain], "loop")
    return _count_modes(above, below, times)


def _count_modes(above: Any, below: Any, times: Mapping[sp.Symbol, sp.Expr]) -> LateRatio:
    unseen, above, below = above.cofactors(below)
    closed, order = above + below, max(above.degree(), below.degree())
    fault = ""
    if modes := describe_growth(unseen, times):
        fault = f"a mode that it does not see grows: {modes}"
    elif closed.degree() < order:
        fault = "its gain is -1 at high frequency: the least change makes a mode grow at once"
    largest = max(abs(c) for side in (above, below) for c in side.values())
    unit = Fraction(int(largest.numerator), int(largest.denominator))
    sides = [terms_of(side, times, unit=unit) for side in (above, below)]
    first = min(t for terms in sides for t in terms)
    made = ({t - first: p for t, p in terms.items()} for terms in sides)
    over, under = made
    return LateRatio(over, under, fault)


def crossings(above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Frequencies at which abs(above/below) = 1, rad/s: roots of a polynomial, none missed.

    above, below: coefficients in s, highest first. A gain within 1e-12 of 1 counts as 1
    """
    sides = [[Fraction(float(c)) for c in side[::-1]] for side in (above, below)]
    rings = [
        RING({(k,): sp.QQ(c.numerator, c.denominator) for k, c in enumerate(side) if c})
        for side in sides
    ]
    first, second = (cross(side, side)[0] for side in rings)
    at = roots_of(first - second)
    near = (at.real > 0) & (np.abs(at.imag) <= 1e-6 * np.abs(at))
    return np.asarray(np.sqrt(at.real[near]))


#: longest step of a phase (rad) or of the logarithm of a size; a longer step is halved. A shorter
#: step that may reach the searched value on its way is also halved, down to FINEST: a value that is
#: reached for less than this may be missed
STEP, FINEST = 0.5, 1e-3
#: most points that are evaluated
_MOST = 2_000_000


class Envelope(NamedTuple):
    """Bounds of a ratio for any phases of its delayed terms, at each frequency, (n,).

    value: of the ratio itself
    least, most: logarithms of its magnitude, for any phases of the delayed terms
    clear: rad, from -180 degrees to the nearest phase that delayed terms can give, < 0 on the side
        below; 0: they reach -180 degrees
    rate: s, change of its phase, or of the logarithm of its magnitude, by dead times per change of
        w
    """

    value: np.ndarray
    least: np.ndarray
    most: np.ndarray
    clear: np.ndarray
    rate: np.ndarray


def envelope(ratio: LateRatio, w: np.ndarray) -> Envelope:
    """The bounds of a ratio at frequencies (n,), rad/s."""
    above, below = (_terms_at(terms, w) for terms in (ratio.above, ratio.below))
    phase = np.angle(-above.at_once * below.at_once.conj())
    turn = above.turn + below.turn
    with np.errstate(divide="ignore", invalid="ignore"):
        return Envelope(
            above.value / below.value,
            np.log(above.least) - np.log(below.most),
            np.log(above.most) - np.log(below.least),
            np.sign(phase) * np.maximum(np.abs(phase) - turn, 0),
            above.rate + below.rate,
        )


def least_between(values: np.ndarray) -> np.ndarray:
    """Lower bound between neighbours: below the smaller value by their difference."""
    low, high = np.minimum(values[1:], values[:-1]), np.maximum(values[1:], values[:-1])
    with np.errstate(invalid="ignore"):  # without a bound on one side: not a number
        return np.asarray(low - (high - low))


def is_followed(
    change: np.ndarray, left: np.ndarray, rate: np.ndarray, w: np.ndarray
) -> np.ndarray:
    """Whether steps of a phase, or of the logarithm of a magnitude, are short enough.

    change: of each step, (n - 1,);  left: distance to the searched value, (n,);  rate: see
        `Envelope`
    """
    steps = change + np.maximum(rate[1:], rate[:-1]) * np.diff(w)
    return np.asarray(steps <= np.clip(left[1:] + left[:-1], FINEST, STEP))


def halve_steps(
    w: np.ndarray,
    points: np.ndarray,
    wide: np.ndarray,
    at: Callable[[np.ndarray], np.ndarray],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Insert the middle of each wide step: w, points, and the steps that were halved.

    points: (k, n), of `at` at w;  wide: indices of steps, in order
    raises ModelError: too many points
    """
    middle = (w[wide] + w[wide + 1]) / 2
    steps, middle = (x[(middle > w[wide]) & (middle < w[wide + 1])] for x in (wide, middle))
    if len(w) + len(steps) > _MOST:
        raise ModelError("gain_margin: the phase turns more often than can be followed")
    after = np.insert(points, steps + 1, at(middle), axis=1)
    return np.insert(w, steps + 1, middle), after, steps


def unity_grid(ratio: LateRatio, w: np.ndarray) -> np.ndarray:
    """The grid (rad/s) with points between which the magnitude crosses 1 once, or not at all."""

    def at(w: np.ndarray) -> np.ndarray:
        here = envelope(ratio, w)
        with np.errstate(divide="ignore"):
            return np.array([np.log(np.abs(here.value)), here.least, here.most, here.rate])

    points = at(w)
    while True:
        size, least, most, rate = points
        with np.errstate(invalid="ignore"):
            known = is_followed(np.abs(np.diff(size)), np.abs(size), rate, w)
            far = np.fmax(least_between(-most), least_between(least)) > 0
        w, points, more = halve_steps(w, points, np.flatnonzero(~known & ~far), at)
        if not len(more):
            return w


def factor_far_out(ratio: LateRatio, w: np.ndarray, *, share: float) -> tuple[float, int]:
    """Gain factor to -1 at high frequency, at least 1, for a ratio that stays level there.

    Also the number of frequencies before the ratio is level within `share`. sum_k (d_k + g n_k)
    e^(-j w T_k) can be 0, at a very small change of dead times, if the largest term is no more than
    the sum of the others. This is linear in g from one corner to the next.
    """
    degree = max(map(len, ratio.below.values()))
    times = sorted({*ratio.above, *ratio.below})
    lead = max(abs(float(p[0])) for p in ratio.below.values() if len(p) == degree)
    both = ratio.below, ratio.above
    sides = [
        [np.polyadd(np.zeros(degree), terms.get(t, np.zeros(0))) / lead for t in times]
        for terms in both
    ]
    d, n = (np.array([p[0] for p in side]) for side in sides)

    def left(g: float) -> float:
        size = np.abs(d + g * n)
        return float(2 * size.max() - size.sum())

    pairs = [(a - b, x - y) for a, x in zip(d, n, strict=True) for b, y in zip(-d, -n, strict=True)]
    pairs += [(a - b, x - y) for a, x in zip(d, n, strict=True) for b, y in zip(d, n, strict=True)]
    corners = sorted({-a / x for a, x in pairs if x and -a / x > 0})
    end = 2 * max([1.0, *corners])
    up = _first_zero(left, [1.0, *(g for g in corners if g > 1), end, 2 * end])
    down = _first_zero(left, [1.0, *(g for g in reversed(corners) if g < 1), 0.0])
    factor = min(up, 1 / down if 0 < down < np.inf else np.inf)
    far = (1j * w) ** (degree - 1)
    off = sum(
        weight * np.abs(np.polyval(p, 1j * w) / far - p[0])
        for side, weight in zip(sides, (1.0, factor if np.isfinite(factor) else 1.0), strict=True)
        for p in side
    )
    before = np.flatnonzero(off > share * np.abs(d).max())
    return max(float(factor), 1.0), min(int(before.max(initial=0)) + 2, len(w))


def _first_zero(left: Callable[[float], float], points: Sequence[float]) -> float:
    """First zero of the polygon through the points, whose last line continues; inf if none.

    A single term only touches 0 at its corner, within rounding: the terms are near 1.
    """
    for k, (a, b) in enumerate(pairwise(points)):
        high, low = left(a), left(b)
        if low <= 1e-14 + 1e-12 * high or (k == len(points) - 2 and low < high and b > a):
            return a + (b - a) * high / (high - low) if high > low else a
    return float("inf")


class _TermsAt(NamedTuple):
    """A sum of delayed terms at each frequency, (n,): see `Envelope`; turn: inf for all phases."""

    value: np.ndarray
    at_once: np.ndarray
    least: np.ndarray
    most: np.ndarray
    turn: np.ndarray
    rate: np.ndarray


def _terms_at(terms: Terms, w: np.ndarray) -> _TermsAt:
    times = np.array(list(terms))[:, None]
    values = np.array([np.polyval(p, 1j * w) for p in terms.values()])
    size, total = np.abs(values), (np.exp(-1j * times * w) * values).sum(axis=0)
    most = size.sum(axis=0)
    rate = (times * size).sum(axis=0) / np.maximum(np.abs(total), 1e-12 * most)
    # what comes at once, where it outweighs the others together, is turned by a part alone
    at_once = (values * (times == 0)).sum(axis=0)
    share = (most - np.abs(at_once)) / np.maximum(np.abs(at_once), 0.1 * most)
    turn = np.where(share < 1, np.arcsin(np.minimum(share, 1)), np.inf)
    least = np.maximum(2 * size.max(axis=0) - most, 0)
    return _TermsAt(total, at_once, least, most, turn, rate)

"""The least value of a law over ranges of its symbols, as a bound, and where it is reached.

Branch and bound: the box with the least lower bound is halved until this bound is as high as the
least value at a point. Where the law is monotone in a symbol, only one end of its range counts.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count

import sympy as sp

from ..base.errors import ModelError
from .enclosure import Enclosure, enclosure_of

#: relative distance of a bound from a value that occurs, at which the bound is tight enough:
#: friction levels are known to 1e-2 at best, and a tenth of this distance needs a few boxes more
TIGHTNESS = 1e-4
#: most boxes for a bound, about 1.3 ms each for a law with 17 symbols; then the bound stays as it
#: is. Most laws of the catalogue need less than a hundred, a wave beside a load up to all of them
MOST_BOXES = 1000
#: most boxes while the law has no bound: further boxes would not change this
MOST_UNBOUNDED = 100

Ranges = Mapping[sp.Symbol, tuple[float, float]]


@dataclass(frozen=True)
class Least:
    """The least value of a law, between a bound and a value that occurs.

    bound: no value is below;  met: the value at `point` is at most this
    point: symbol -> value; a large value may stand for a limit at infinity
    """

    bound: float
    met: float
    point: Mapping[sp.Symbol, float]


@dataclass(order=True, frozen=True)
class _Box:
    """Of equal bounds the newest box is looked at first; those without end after all others, the
    oldest first: neither side of a line is followed outwards for ever.
    """

    bound: float
    turn: tuple[bool, int]
    ranges: tuple[tuple[float, float], ...] = field(compare=False)


class _Search:
    """A law on a box: enclosures, slopes, and the least value at a point so far."""

    def __init__(self, law: sp.Expr, ranges: Ranges) -> None:
        self.symbols = [s for s in ranges if law.has(s)]
        # numbers of numpy take several times as long
        self.start = tuple((float(a), float(b)) for a, b in (ranges[s] for s in self.symbols))
        self.value = enclosure_of(law, self.symbols)
        self.slopes = [_slope(law, s, self.symbols) for s in self.symbols]
        self.met, self.point = math.inf, tuple(_middle(r) for r in self.start)
        self.serial = count()

    def over(self, ranges: Sequence[tuple[float, float]]) -> tuple[float, float]:
        return self.value(ranges)

    def meet(self, point: Sequence[float]) -> None:
        value = self.over([(x, x) for x in point])[1]
        if value < self.met:
            self.met, self.point = value, tuple(point)

    def box(self, ranges: tuple[tuple[float, float], ...]) -> _Box:
        """The box, narrowed to the ends where a monotone law is least, with points evaluated."""
        narrow = list(ranges)
        for i, slope in enumerate(self.slopes):
            low, high = narrow[i]
            if low == high or slope is None:
                continue
            # beside a pole, where the law may jump, no slope has finite bounds
            least, most = slope(narrow)
            if least >= 0 and math.isfinite(most) and math.isfinite(low):
                narrow[i] = low, low
            elif most <= 0 and math.isfinite(least) and math.isfinite(high):
                narrow[i] = high, high
        for at in (_middle, _first, _last):
            self.meet([at(r) for r in narrow])
        is_open, number = any(math.isinf(x) for r in narrow for x in r), next(self.serial)
        turn = is_open, number if is_open else -number
        return _Box(self.over(narrow)[0], turn, tuple(narrow))

    def split(self, box: _Box) -> list[_Box]:
        """Two halves along the range that widens the enclosure most; none where all are points."""
        best, least = -1, (math.inf, 0.0)
        for i, (low, high) in enumerate(box.ranges):
            middle = _middle((low, high))
            if not low < middle < high:
                continue
            held = [*box.ranges[:i], (middle, middle), *box.ranges[i + 1 :]]
            left = self.over(held)
            rank = (left[1] - left[0], -(high - low))
            if best < 0 or rank < least:
                best, least = i, rank
        if best < 0:
            return []
        low, high = box.ranges[best]
        middle = _middle((low, high))
        halves = (low, middle), (middle, high)
        return [self.box((*box.ranges[:best], h, *box.ranges[best + 1 :])) for h in halves]


def least_value(law: sp.Expr, ranges: Ranges) -> Least:
    """The least value of the law over ranges of its symbols, which may be unbounded.

    The bound is -inf where the law has no finite least value, or no finite bound is known.
    raises ModelError: a symbol has no range, or a function has no known bound
    """
    if strangers := law.free_symbols - set(ranges):
        raise ModelError(f"no guaranteed bound: no range of {', '.join(map(str, strangers))}")
    search = _Search(law, ranges)
    waiting = [search.box(search.start)]
    typical = abs(search.over([(x, x) for x in search.point])[1])
    finished = math.inf  # the least bound of boxes that cannot be halved
    for looked_at in range(MOST_BOXES):
        tolerance = TIGHTNESS * max(abs(search.met), typical if math.isfinite(typical) else 0.0)
        if not waiting or waiting[0].bound >= min(search.met, finished) - tolerance:
            break
        if math.isinf(waiting[0].bound) and looked_at >= MOST_UNBOUNDED:
            break
        lowest = heapq.heappop(waiting)
        halves = search.split(lowest)
        if not halves:
            finished = min(finished, lowest.bound)
        for half in halves:
            heapq.heappush(waiting, half)
    bound = min([finished, *(box.bound for box in waiting)])
    return Least(bound, search.met, dict(zip(search.symbols, search.point, strict=True)))


def _slope(
    law: sp.Expr, symbol: sp.Symbol, symbols: Sequence[sp.Symbol]
) -> Callable[[Sequence[Enclosure]], Enclosure] | None:
    """The enclosure of the derivative; None where it does not show monotony.

    Pieces may jump, and atan(tan(x)), whose derivative is simplified to 1.
    """
    if law.has(sp.Piecewise, sp.Heaviside, sp.tan):
        return None
    try:
        # a kink is no jump: signs of a derivative are any between -1 and 1 there
        return enclosure_of(sp.diff(law, symbol), symbols)
    except ModelError:
        return None


def _middle(range_: tuple[float, float]) -> float:
    """The point where a range is halved; an unbounded range is halved at twice its finite end."""
    low, high = range_
    if math.isinf(low) and math.isinf(high):
        return 0.0
    if math.isinf(high):
        return max(2 * low, 1.0) if low >= 0 else 0.0
    if math.isinf(low):
        return min(2 * high, -1.0) if high <= 0 else 0.0
    return low + (high - low) / 2


def _first(range_: tuple[float, float]) -> float:
    return range_[0] if math.isfinite(range_[0]) else _middle(range_)


def _last(range_: tuple[float, float]) -> float:
    return range_[1] if math.isfinite(range_[1]) else _middle(range_)

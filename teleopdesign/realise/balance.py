"""Static friction along a measured motion: the force that balances where no motion is certain.

Within its bounds, friction has the value that leaves the smallest residual within the bandwidth.
Accelerated projected steps (Beck, Teboulle, SIAM J. Imaging Sciences 2, 2009) compute it from the
low-passed difference to the needed force. Clipping the needed force itself would turn its noise
above the bandwidth into a bias below it. A few plain steps do not converge near the edge of the
band: next to a reversal a right model then leaves two to four times its noise. The low-pass passes
only a part of what few open rows change, so that their steps are longer by the same factor.
Values and tangents are computed together.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..base.machine import compile_and_keep
from ..measurement.filtering import Array
from ..measurement.zero_phase import filter_both_ways, lanes, margin, sections
from ..measurement.zero_phase_spans import (
    connect_spans,
    crossings,
    filter_spans,
    gains,
    reach,
    response,
    spans_of,
    windows,
)
from .traced import Traced, joined_rows

#: iterations: on 109 simulated records of right models the 95th percentile of the remaining error,
#: over that of the drawn sensor errors, is 1.12 after these, and 1.11 after twice as many
STEPS = 8


#: four columns of one row. All are read before any is written: else LLVM makes no vectors of them,
#: for it cannot tell that the arrays do not overlap
_Four = tuple[float, float, float, float]


@compile_and_keep
def _four(values: Array, i: int, j: int) -> _Four:
    return values[i, j], values[i, j + 1], values[i, j + 2], values[i, j + 3]


@compile_and_keep
def _set_four(values: Array, i: int, j: int, four: _Four) -> None:
    values[i, j], values[i, j + 1], values[i, j + 2], values[i, j + 3] = four


@compile_and_keep
def _sum(one: _Four, other: _Four, factor: float = 1.0) -> _Four:
    """One plus the other times a factor."""
    return (
        one[0] + factor * other[0],
        one[1] + factor * other[1],
        one[2] + factor * other[2],
        one[3] + factor * other[3],
    )


@compile_and_keep
def _balance(
    left: Array,
    open_rows: tuple[NDArray[np.intp], Array],
    there: Array,
    spans: NDArray[np.intp],
    m: int,
    filters: tuple[Array, Array, Array, Array],
) -> Array:
    """Friction at the rows where its bounds differ; columns: the value, then its tangents.

    left: needed less friction at all samples, changed in place
    open_rows: indices of these rows, and the length of the steps there over the low-passed residual
    there: (3, rows, columns), needed force at these rows, least and largest friction
    spans: of `spans_of` these rows;  m: samples by which records are continued
    filters: as `filter_spans` takes them
    """
    n, r = left.shape
    whole = r - r % 4
    (rows, lengths), (sos, steady, _, _) = open_rows, filters
    needed = there[0]
    extended = np.zeros((n + 2 * m, r))
    friction: Array = np.zeros_like(needed)
    smooth, ahead = np.zeros_like(needed), needed.copy()
    momentum, carried = 1.0, 0.0
    for turn in range(STEPS + 1):
        if turn == 1:
            filter_both_ways(left, extended, sos, steady)
            left[:] = 0.0  # from now on: only the change from one step to the next
        elif turn > 1:
            filter_spans(left, extended, spans, filters)
        if turn > 0:
            later = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * momentum**2))
            carried = (momentum - 1.0) / later
            momentum = later
        for i, k in enumerate(rows):
            length = lengths[i]
            value = ahead[i, 0] + length * (smooth[i, 0] + extended[m + k, 0])
            # where the value is clipped, its tangents are the bound's
            clipped = 2 if value >= there[2, i, 0] else 1 if value <= there[1, i, 0] else 0
            bound = there[clipped]
            for j in range(0, whole, 4):
                smoothed = _sum(_four(smooth, i, j), _four(extended, m + k, j))
                before = _four(ahead, i, j)
                now = _four(bound, i, j) if clipped else _sum(before, smoothed, length)
                change = _sum(now, _four(friction, i, j), -1.0)
                next_ahead = _sum(now, change, carried)
                _set_four(smooth, i, j, smoothed)
                _set_four(left, k, j, _sum(before, next_ahead, -1.0))
                _set_four(ahead, i, j, next_ahead)
                _set_four(friction, i, j, now)
            for j in range(whole, r):
                smooth[i, j] += extended[m + k, j]
                one = bound[i, j] if clipped else ahead[i, j] + length * smooth[i, j]
                one_ahead = one + carried * (one - friction[i, j])
                left[k, j] = ahead[i, j] - one_ahead
                ahead[i, j] = one_ahead
                friction[i, j] = one
    return friction


def side_by_side(signal: Traced) -> Array:
    """Value and tangents of a signal, as columns (samples, lanes)."""
    beside = np.zeros((len(signal.value), lanes(1 + len(signal.tangent))))
    _fill_columns(beside, signal, slice(None))
    return beside


def _fill_columns(columns: Array, signal: Traced, at: slice | NDArray[np.intp]) -> None:
    """Write value and tangents of a signal at some samples into columns of zeros."""
    columns[:, 0] = signal.value[at]
    if not signal.is_constant:
        for j in signal.moving_rows:
            columns[:, 1 + j] = signal.tangent[j][at]


def balance_within_bounds(
    needed: Traced, low: Traced, high: Traced, *, bandwidth: float, sample_time: float
) -> Traced:
    """Friction between its bounds, with its tangents.

    needed, low, high: (n,) force, its tangents (p, n) each;  bandwidth: Hz;  sample_time: s
    """
    is_open = low.value != high.value
    both = None if low.moving is None or high.moving is None else {*low.moving, *high.moving}
    for j in range(len(low.tangent)) if both is None else both:
        is_open |= low.tangent[j] != high.tangent[j]
    if not is_open.any():
        return low
    friction = low.rows()
    for window in _list_windows(is_open.tobytes(), bandwidth, sample_time):
        here = window.here
        friction[:, here.start + window.rows] = _friction_at_open_rows(
            needed.between(here), low.between(here), high.between(here), window
        )
    return Traced(friction[0], friction[1:], joined_rows(needed, low, high))


@dataclass(frozen=True, eq=False)
class _Window:
    """A part of a record beyond which its open rows have no influence.

    rows: indices of its open rows within it;  lengths: of their steps
    m: samples by which it is continued
    spans: of `spans_of` these rows;  filters: as `filter_spans` takes them
    """

    here: slice
    rows: NDArray[np.intp]
    lengths: Array
    m: int
    spans: NDArray[np.intp]
    filters: tuple[Array, Array, Array, Array]


# most models of a search have their open rows where the readings show no motion: the same ones
@lru_cache(maxsize=16)
def _list_windows(is_open: bytes, bandwidth: float, sample_time: float) -> tuple[_Window, ...]:
    """Windows of a record of n samples, whose open rows are marked by n bytes."""
    rows, n = np.flatnonzero(np.frombuffer(is_open, dtype=bool)), len(is_open)
    m = margin(n, sample_time)
    of_filter = bandwidth, sample_time
    listed = []
    for first, last in windows(rows, n, m, reach(*of_filter)):
        mine = rows[(rows >= first) & (rows < last)] - first
        # a window between others has no effect of its ends at the open rows
        ends = min(m if first == 0 or last == n else 1, last - first - 1)
        spans = spans_of(mine, last - first, ends, bandwidth * sample_time)
        filters = (*sections(*of_filter), *connect_spans(spans, *crossings(*of_filter)))
        lengths = 1.0 / gains(mine, last - first, response(*of_filter))
        listed.append(_Window(slice(first, last), mine, lengths, ends, spans, filters))
    return tuple(listed)


def _friction_at_open_rows(needed: Traced, low: Traced, high: Traced, window: _Window) -> Array:
    """Friction and its tangents (1 + p, rows) where its bounds differ."""
    rows, count = window.rows, 1 + len(needed.tangent)
    left = side_by_side(needed - low)
    there = np.zeros((3, len(rows), lanes(count)))
    for columns, signal in zip(there, (needed, low, high), strict=True):
        _fill_columns(columns, signal, rows)
    friction = _balance(left, (rows, window.lengths), there, window.spans, window.m, window.filters)
    return friction[:, :count].T

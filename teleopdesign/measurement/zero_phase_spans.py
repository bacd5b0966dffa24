"""The low-pass of the comparison for signals that are zero except in a few rows: exact, and faster.

The force that friction takes up changes only where the motion is uncertain. Between such rows the
filter has no input: its states from one span to the next follow powers of one matrix, and the
effect of its output on the backward pass follows another matrix. Both are composed from those for
1, 2, 4 ... rows. Nothing is neglected.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..base.machine import compile_and_keep
from .filtering import Array
from .zero_phase import copy_rows, go_on, sections, settle, zero_phase

#: spans with at most so many rows between them are joined: a gap costs as much as filtering so many
#: rows
NEAR = 16
#: decay of the influence of a row on the filter's output that counts as complete: below rounding
NOTHING = 1e-18
#: share of the largest influence of a row on the output; rows with less influence count as apart,
#: which changes a gain by some thousandths
APART = 1e-3
#: if windows cover more than this share of a record, the whole record is filtered: each window
#: costs a call
MOST_SHARE = 0.7
#: lowest cutoff over the sample rate at which the states of the filter are carried between spans:
#: at half of it, rounding loses 1e-9 of them, and more at lower ones. Below it, one span covers all
LEAST_CUTOFF = 1e-3
#: number of powers of two that add up to the rows between two spans: enough for any record
DOUBLINGS = 40
#: smaller elements of such a power count as zero: their squares would underflow
TINY = 1e-100


def spans_of(rows: NDArray[np.intp], n: int, m: int, cutoff: float) -> NDArray[np.intp]:
    """Spans (k, 2), from and to, of the continued record that contain every change by these rows.

    rows: of the record of n samples, in order; the record is continued by m samples at each end
    cutoff: of the filter, over the sample rate
    """
    if cutoff < LEAST_CUTOFF:
        return np.array([[0, n + 2 * m]])
    changed = np.zeros(n + 2 * m, dtype=bool)
    changed[m + rows] = True
    # the continuation is the mirror image of the outermost rows, so it changes with them
    changed[m - rows[rows <= m]] = True
    changed[m + 2 * (n - 1) - rows[rows >= n - 1 - m]] = True
    changed[:m] |= rows[0] == 0
    changed[m + n :] |= rows[-1] == n - 1
    changed[[0, -1]] = True  # where the filter begins in each direction
    places = np.flatnonzero(changed)
    ends = np.flatnonzero(np.diff(places) > NEAR + 1)
    return np.column_stack([places[np.append(0, ends + 1)], places[np.append(ends, -1)] + 1])


@lru_cache(maxsize=16)
def reach(cutoff: float, sample_time: float) -> int:
    """Rows after which the influence of one row on the filter's output is below rounding."""
    sos, _ = sections(cutoff, sample_time)
    slowest = max(float(np.abs(np.roots(section[3:])).max()) for section in sos)
    return int(np.ceil(np.log(NOTHING) / np.log(slowest)))


@lru_cache(maxsize=16)
def response(cutoff: float, sample_time: float) -> Array:
    """Magnitude of a row's influence on the output 0, 1, 2 ... rows away, as far as `APART`."""
    far = reach(cutoff, sample_time)
    impulse = np.zeros(2 * far + 1)
    impulse[far] = 1.0
    influence = np.abs(zero_phase(impulse, cutoff, sample_time)[far:])
    return influence[: 1 + int(np.flatnonzero(influence > APART * influence[0])[-1])]


@compile_and_keep
def gains(rows: NDArray[np.intp], n: int, response: Array) -> Array:
    """Bound of the filter's gain for changes at these rows alone, one for each row.

    rows: in order, of n samples;  response: see `response`
    Rows that are apart from others form groups; a group has the gain of its row with the largest
    sum of influences (Gershgorin), at most 1. Rows near an end of the record have gain 1.
    """
    count, far = len(rows), len(response)
    bounds = np.ones(count)
    begin = 0
    while begin < count:
        end = begin + 1
        while end < count and rows[end] - rows[end - 1] < far:
            end += 1
        largest = 1.0 if rows[begin] < far or rows[end - 1] >= n - far else 0.0
        first = begin
        for i in range(begin, end):
            if largest >= 1.0:
                break
            while rows[i] - rows[first] >= far:
                first += 1
            total, j = 0.0, first
            while j < end and rows[j] - rows[i] < far:
                total += response[abs(rows[j] - rows[i])]
                j += 1
            largest = max(largest, total)
        bounds[begin:end] = min(largest, 1.0)
        begin = end
    return bounds


def windows(rows: NDArray[np.intp], n: int, m: int, reach: int) -> list[tuple[int, int]]:
    """Windows (from, to) of n samples outside of which these rows have no influence on each other.

    rows: in order;  m: samples by which the record is continued at each end;  reach: see `reach`
    One window covers all samples if little would be left out.
    """
    apart = np.flatnonzero(np.diff(rows) > 2 * reach)
    begins = np.maximum(rows[np.append(0, apart + 1)] - reach, 0)
    ends = np.minimum(rows[np.append(apart, -1)] + reach + 1, n)
    if begins[0] == 0:  # the continuation there mirrors the first m rows
        ends[0] = max(ends[0], min(m + 1, n))
    if ends[-1] == n:  # and here the last m rows
        begins[-1] = min(begins[-1], max(n - 1 - m, 0))
    if np.any(begins[1:] < ends[:-1]) or (ends - begins).sum() > MOST_SHARE * n:
        return [(0, n)]
    return list(zip(begins.tolist(), ends.tolist(), strict=True))


@lru_cache(maxsize=16)
def crossings(cutoff: float, sample_time: float) -> tuple[Array, Array]:
    """Effect of 1, 2, 4, ... rows of zero input on the states of the filter, two arrays (k, 4, 4).

    The first array maps the states across these rows, in either direction. The second maps the
    forward states before the rows to their contribution to the backward states after the rows.
    """
    sos, _ = sections(cutoff, sample_time)
    states, output = np.eye(4).reshape(2, 2, 4), np.zeros((1, 4))
    go_on(output, states, sos, False)
    entering, one = np.zeros((2, 2, 1)), np.ones((1, 1))
    go_on(one, entering, sos, False)
    free, back = [states.reshape(4, 4)], [entering.reshape(4, 1) @ output]
    for _ in range(DOUBLINGS - 1):
        step, swing = free[-1], back[-1]
        back.append(swing + step @ swing @ step)
        free.append(np.where(np.abs(step) < TINY, 0.0, step) @ step)
    return np.array(free), np.array(back)


@compile_and_keep
def _multiply(to: Array, left: Array, right: Array) -> None:
    """Add the product of matrices (4, 4) and states (4, signals), or of two matrices, to `to`."""
    for i in range(4):
        for k in range(4):
            for j in range(right.shape[1]):
                to[i, j] += left[i, k] * right[k, j]


@compile_and_keep
def _cross(rows: int, step: Array, swing: Array, free: Array, back: Array) -> None:
    """Set both matrices (4, 4) of `crossings` for any number of rows, from powers of two.

    step, swing: zeros on entry
    """
    for i in range(4):
        step[i, i] = 1.0
    power = 0
    while rows > 0:
        if rows % 2:
            pushed, next_step = np.zeros((4, 4)), np.zeros((4, 4))
            _multiply(pushed, step, back[power])
            _multiply(swing, pushed, step)
            _multiply(next_step, step, free[power])
            for i in range(4):
                for j in range(4):
                    step[i, j] = next_step[i, j]
        rows //= 2
        power += 1


@compile_and_keep
def connect_spans(spans: NDArray[np.intp], free: Array, back: Array) -> tuple[Array, Array]:
    """Both matrices of `crossings` from each span to the next, (k, 4, 4); zeros before the first.

    free, back: from `crossings`
    """
    steps, swings = np.zeros((len(spans), 4, 4)), np.zeros((len(spans), 4, 4))
    for c in range(1, len(spans)):
        _cross(spans[c, 0] - spans[c - 1, 1], steps[c], swings[c], free, back)
    return steps, swings


@compile_and_keep
def _fill_span(extended: Array, y: Array, begin: int, end: int) -> None:
    """Copy rows of y (n, signals) to the continued record, by point symmetry beyond its ends."""
    n, r = y.shape
    m = (extended.shape[0] - n) // 2
    for e in range(begin, min(end, m)):
        for j in range(r):
            extended[e, j] = 2.0 * y[0, j] - y[m - e, j]
    for e in range(max(begin, m + n), end):
        for j in range(r):
            extended[e, j] = 2.0 * y[n - 1, j] - y[m + 2 * (n - 1) - e, j]
    first, last = max(begin - m, 0), min(end - m, n)
    if first < last:
        copy_rows(y[first:last], extended[m + first : m + last])


@compile_and_keep
def filter_spans(
    y: Array,
    extended: Array,
    spans: NDArray[np.intp],
    filters: tuple[Array, Array, Array, Array],
) -> None:
    """Filter the columns of y (n, signals) forward and backward; y is zero outside the spans.

    extended: (m + n + m, signals); afterwards its rows m + k hold row k of the filtered signals if
        this row is in a span; other rows are undefined
    filters: from `sections`, and then from `connect_spans`
    """
    n, r = y.shape
    sos, steady_state, steps, swings = filters
    m = (extended.shape[0] - n) // 2
    count = len(spans)
    states = np.zeros((2 * count, 4, r))  # after each span, in both directions
    # one call of `go_on` for both directions, as in `filter_both_ways`
    for visit in range(2 * count):
        back = visit >= count
        c = 2 * count - 1 - visit if back else visit
        begin, end, here = spans[c, 0], spans[c, 1], states[visit]
        if back:
            begin = max(begin, m)
            if end <= m:
                break
        else:
            _fill_span(extended, y, begin, end)
        if visit == 0 or visit == count:
            last = extended[end - 1] if back else extended[begin]
            settle(here.reshape(2, 2, r), steady_state, last)
        elif back:
            _multiply(here, steps[c + 1], states[visit - 1])
            _multiply(here, swings[c + 1], states[c])
        else:
            _multiply(here, steps[c], states[visit - 1])
        go_on(extended[begin:end], here.reshape(2, 2, r), sos, back)

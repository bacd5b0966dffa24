"""The low-pass of the comparison in time: 4th-order Butterworth, forward and backward, compiled.

Many signals lie side by side in memory, so that the processor filters them together. The record is
continued by point symmetry at both ends, and the filter starts there in steady state.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..base.machine import compile_and_keep
from .filtering import CONTINUED, Array

#: decay of the influence of a row on the filter's output that counts as complete: below rounding
NOTHING = 1e-18
#: share of the largest influence of a row on the output; rows with less influence count as apart,
#: which changes a gain by some thousandths
APART = 1e-3
#: if windows cover more than this share of a record, the whole record is filtered: each window
#: costs a call
MOST_SHARE = 0.7


@lru_cache(maxsize=64)
def sections(cutoff: float, sample_time: float) -> tuple[Array, Array]:
    """Second-order sections (2, 6) of the one-way filter and their steady states (2, 2).

    cutoff: Hz, -3 dB of the one-way filter
    """
    from scipy.signal import butter, sosfilt_zi

    sos = butter(4, cutoff, fs=1.0 / sample_time, output="sos")
    return np.ascontiguousarray(sos), np.ascontiguousarray(sosfilt_zi(sos))


def margin(n: int, sample_time: float) -> int:
    """Number of samples by which a record of n samples is continued at each end."""
    return max(1, min(round(CONTINUED / sample_time), n - 1))


def lanes(signals: int) -> int:
    """Number of columns to reserve for some signals: eight, twelve ... columns are fastest.

    One or two signals get one or two columns.
    """
    return signals if signals < 3 else max(8, -(-signals // 4) * 4)


@compile_and_keep
def settle(states: Array, steady_state: Array, row: Array) -> None:
    """Set the states (2, 2, signals) to the steady state of a constant signal of value `row`."""
    for s in range(2):
        for i in range(2):
            for j in range(len(row)):
                states[s, i, j] = steady_state[s, i] * row[j]


@compile_and_keep
def go_on(y: Array, states: Array, sos: Array, backward: bool) -> None:
    """Filter the columns of y (samples, signals) in place, starting from given states.

    states: (2, 2, signals), overwritten by the states at the other end
    """
    n, r = y.shape
    b0, b1, b2, a1, a2 = sos[0, 0], sos[0, 1], sos[0, 2], sos[0, 4], sos[0, 5]
    d0, d1, d2, c1, c2 = sos[1, 0], sos[1, 1], sos[1, 2], sos[1, 4], sos[1, 5]
    for step in range(n):
        k = n - 1 - step if backward else step
        for j in range(r):
            x = y[k, j]
            first = b0 * x + states[0, 0, j]
            states[0, 0, j] = b1 * x - a1 * first + states[0, 1, j]
            states[0, 1, j] = b2 * x - a2 * first
            second = d0 * first + states[1, 0, j]
            states[1, 0, j] = d1 * first - c1 * second + states[1, 1, j]
            states[1, 1, j] = d2 * first - c2 * second
            y[k, j] = second


@compile_and_keep
def copy_rows(values: Array, to: Array) -> None:
    """Copy the rows of one array into another; both are contiguous in memory.

    Element by element: for whole rows numba compiles a check of shapes, which takes three times as
    long.
    """
    flat, there = values.ravel(), to.ravel()
    for i in range(values.size):
        there[i] = flat[i]


@compile_and_keep
def filter_both_ways(y: Array, extended: Array, sos: Array, steady_state: Array) -> None:
    """Filter the columns of y (n samples, signals) forward and backward: zero phase.

    extended: (m + n + m, signals); afterwards its rows m to m + n are the filtered signals
    """
    n, r = y.shape
    m = (extended.shape[0] - n) // 2
    for k in range(m):
        for j in range(r):
            extended[k, j] = 2.0 * y[0, j] - y[m - k, j]
            extended[m + n + k, j] = 2.0 * y[n - 1, j] - y[n - 2 - k, j]
    copy_rows(y, extended[m : m + n])
    states = np.empty((2, 2, r))
    # one loop for both directions: LLVM vectorises two copies of the loop badly, which takes twice
    # as long
    for way in range(2):
        there = extended[way * m :]
        settle(states, steady_state, there[way * (len(there) - 1)])
        go_on(there, states, sos, way == 1)


def columns(rows: Array) -> Array:
    """Signals (r, n) side by side in memory: (n, lanes), with zeros in the remaining lanes."""
    r, n = rows.shape
    side_by_side = np.zeros((n, lanes(r)))
    side_by_side[:, :r] = rows.T
    return side_by_side


def zero_phase(
    y: Array, cutoff: float, sample_time: float, at: NDArray[np.intp] | None = None
) -> Array:
    """Signals (..., n) through the zero-phase low-pass.

    cutoff: Hz, -3 dB of the one-way filter;  sample_time: s
    at: indices of the wanted samples; None: all
    """
    n = y.shape[-1]
    rows = y.reshape(-1, n)
    m = margin(n, sample_time)
    side_by_side = columns(rows)
    extended = np.empty((n + 2 * m, side_by_side.shape[1]))
    filter_both_ways(side_by_side, extended, *sections(cutoff, sample_time))
    filtered = extended[m : m + n] if at is None else extended[m + at]
    return np.ascontiguousarray(filtered[:, : len(rows)].T).reshape(*y.shape[:-1], -1)


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

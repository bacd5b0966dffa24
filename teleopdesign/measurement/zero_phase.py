"""The comparison's low-pass in time: Butterworth of 4th order, run forward and backward, compiled.

Many signals at once, side by side in memory, so that the processor filters them together. The
record is continued oddly at both ends and the filter starts in steady state there.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..machine_code import compile_and_keep
from .eight_numbers import EIGHT, put, scale, scale_and_add, take
from .filtering import CONTINUED, Array


@lru_cache(maxsize=64)
def sections(cutoff: float, sample_time: float) -> tuple[Array, Array]:
    """Second-order sections (2, 6) of the one-way filter and their steady states (2, 2).

    In closed form, by the bilinear transform: to import a library for it takes half a second.
    cutoff: Hz, -3 dB of the one-way filter
    raises ValueError: it is no frequency below half the sample rate
    """
    if not 0.0 < cutoff * sample_time < 0.5:
        raise ValueError(f"a low-pass at {cutoff:g} Hz of samples {sample_time:g} s apart")
    edge = np.tan(np.pi * cutoff * sample_time)
    sos, steady = np.empty((2, 6)), np.empty((2, 2))
    # analog poles at these angles to either side of the negative axis
    for section, angle in enumerate((np.pi / 8, 3 * np.pi / 8)):
        damping = 2.0 * np.cos(angle) * edge
        whole = 1.0 + damping + edge**2
        gain = edge**2 / whole
        a1, a2 = 2.0 * (edge**2 - 1.0) / whole, (1.0 - damping + edge**2) / whole
        sos[section] = gain, 2.0 * gain, gain, 1.0, a1, a2
        steady[section] = 1.0 - gain, gain - a2
    return sos, steady


def margin(n: int, sample_time: float) -> int:
    """Samples by which a record of n samples is continued at each end."""
    return max(1, min(round(CONTINUED / sample_time), n - 1))


def lanes(signals: int) -> int:
    """Columns to set aside for so many signals: filters take eight of them at once.

    One or two are filtered as they are.
    """
    return signals if signals < 3 else -(-signals // EIGHT) * EIGHT


@compile_and_keep
def settle(states: Array, steady_state: Array, row: Array) -> None:
    """Set the states (2, 2, signals) to those of a signal that has always been this row."""
    for s in range(2):
        for i in range(2):
            for j in range(len(row)):
                states[s, i, j] = steady_state[s, i] * row[j]


@compile_and_keep
def go_on(y: Array, states: Array, sos: Array, backward: bool) -> None:
    """Filter the columns of y (samples, signals) in place, from these states on.

    states: (2, 2, signals), afterwards those at the other end
    """
    n, r = y.shape
    b0, b1, b2, a1, a2 = sos[0, 0], sos[0, 1], sos[0, 2], -sos[0, 4], -sos[0, 5]
    d0, d1, d2, c1, c2 = sos[1, 0], sos[1, 1], sos[1, 2], -sos[1, 4], -sos[1, 5]
    first_at, way = ((n - 1) * r, -r) if backward else (0, r)
    flat, known, eights = y.reshape(-1), states.reshape(-1), r // EIGHT * EIGHT
    for lane in range(0, eights, EIGHT):
        p, q = take(known, lane), take(known, r + lane)
        v, w = take(known, 2 * r + lane), take(known, 3 * r + lane)
        for step in range(n):
            at = first_at + step * way + lane
            x = take(flat, at)
            first = scale_and_add(b0, x, p)
            # a state waits for one product alone: the other sum is ready before
            p = scale_and_add(a1, first, scale_and_add(b1, x, q))
            q = scale_and_add(a2, first, scale(b2, x))
            second = scale_and_add(d0, first, v)
            v = scale_and_add(c1, second, scale_and_add(d1, first, w))
            w = scale_and_add(c2, second, scale(d2, first))
            put(second, flat, at)
        put(p, known, lane)
        put(q, known, r + lane)
        put(v, known, 2 * r + lane)
        put(w, known, 3 * r + lane)
    for lane in range(eights, r):
        p_1, q_1, v_1, w_1 = (
            states[0, 0, lane],
            states[0, 1, lane],
            states[1, 0, lane],
            states[1, 1, lane],
        )
        for step in range(n):
            at = first_at + step * way + lane
            x_1 = flat[at]
            first_1 = b0 * x_1 + p_1
            p_1 = b1 * x_1 + q_1 + a1 * first_1
            q_1 = b2 * x_1 + a2 * first_1
            flat[at] = d0 * first_1 + v_1
            v_1 = d1 * first_1 + w_1 + c1 * flat[at]
            w_1 = d2 * first_1 + c2 * flat[at]
        states[0, 0, lane], states[0, 1, lane], states[1, 0, lane], states[1, 1, lane] = (
            p_1,
            q_1,
            v_1,
            w_1,
        )


@compile_and_keep
def copy_rows(values: Array, to: Array) -> None:
    """Copy the rows of one array into another; both lie without gaps in memory.

    One by one: for rows at once numba compiles a check of shapes, which takes three times as long.
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
    for way in range(2):
        there = extended[way * m :]
        settle(states, steady_state, there[way * (len(there) - 1)])
        go_on(there, states, sos, way == 1)


def columns(rows: Array) -> Array:
    """Signals (r, n) side by side in memory: (n, lanes), zeros in the lanes that are left over."""
    r, n = rows.shape
    side_by_side = np.zeros((n, lanes(r)))
    side_by_side[:, :r] = rows.T
    return side_by_side


def zero_phase(
    y: Array, cutoff: float, sample_time: float, at: NDArray[np.intp] | None = None
) -> Array:
    """Signals (..., n) through the low-pass;  cutoff: Hz;  at: samples that are wanted of it."""
    n = y.shape[-1]
    rows = y.reshape(-1, n)
    m = margin(n, sample_time)
    side_by_side = columns(rows)
    extended = np.empty((n + 2 * m, side_by_side.shape[1]))
    filter_both_ways(side_by_side, extended, *sections(cutoff, sample_time))
    filtered = extended[m : m + n] if at is None else extended[m + at]
    return np.ascontiguousarray(filtered[:, : len(rows)].T).reshape(*y.shape[:-1], -1)

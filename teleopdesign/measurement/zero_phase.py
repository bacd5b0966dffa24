"""The comparison's low-pass in time: Butterworth of 4th order, run forward and backward, compiled.

Many signals at once, side by side in memory, so that the processor filters them together. The
record is continued oddly at both ends and the filter starts settled there.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.signal import butter, sosfilt_zi

from ..machine_code import kept
from .filtering import CONTINUED, Array


@lru_cache(maxsize=64)
def sections(cutoff: float, sample_time: float) -> tuple[Array, Array]:
    """Second-order sections (2, 6) of the one-way filter and their settled states (2, 2).

    cutoff: Hz, -3 dB of the one-way filter
    """
    sos = butter(4, cutoff, fs=1.0 / sample_time, output="sos")
    return np.ascontiguousarray(sos), np.ascontiguousarray(sosfilt_zi(sos))


def margin(n: int, sample_time: float) -> int:
    """Samples by which a record of n samples is continued at each end."""
    return max(1, min(round(CONTINUED / sample_time), n - 1))


@kept
def one_way(y: Array, sos: Array, steady_state: Array, backward: bool) -> None:
    """Filter the columns of y (samples, signals) in place, from one end to the other."""
    n, r = y.shape
    states = np.empty((2, 2, r))
    first = n - 1 if backward else 0
    for s in range(2):
        for i in range(2):
            for j in range(r):
                states[s, i, j] = steady_state[s, i] * y[first, j]
    for step in range(n):
        k = n - 1 - step if backward else step
        for s in range(2):
            b0, b1, b2, a1, a2 = sos[s, 0], sos[s, 1], sos[s, 2], sos[s, 4], sos[s, 5]
            for j in range(r):
                x = y[k, j]
                out = b0 * x + states[s, 0, j]
                states[s, 0, j] = b1 * x - a1 * out + states[s, 1, j]
                states[s, 1, j] = b2 * x - a2 * out
                y[k, j] = out


@kept
def both_ways(y: Array, extended: Array, sos: Array, steady_state: Array) -> None:
    """Filter the columns of y (samples, signals) in place, zero phase; extended: work space."""
    n, r = y.shape
    m = (extended.shape[0] - n) // 2
    for k in range(m):
        for j in range(r):
            extended[k, j] = 2.0 * y[0, j] - y[m - k, j]
            extended[m + n + k, j] = 2.0 * y[n - 1, j] - y[n - 2 - k, j]
    extended[m : m + n] = y
    one_way(extended, sos, steady_state, False)
    one_way(extended, sos, steady_state, True)
    y[:] = extended[m : m + n]


def zero_phase(y: Array, cutoff: float, sample_time: float) -> Array:
    """Signals (..., n) through the low-pass; cutoff in Hz."""
    n = y.shape[-1]
    columns = np.array(y.reshape(-1, n).T, order="C")  # a copy: it is filtered in place
    extended = np.empty((n + 2 * margin(n, sample_time), columns.shape[1]))
    both_ways(columns, extended, *sections(cutoff, sample_time))
    return np.ascontiguousarray(columns.T).reshape(y.shape)

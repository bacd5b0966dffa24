"""Time stamps of an even clock, exact or rounded: the sample time by least squares."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .record_clock import Array, RecordClock, check_duration

_JITTER = 0.2  # deviation of a step from the others, in sample times, that counts as jitter
_EQUAL = 0.02  # if mean and usual step differ by less, rare odd steps are lost samples


def even_clock(stamps: Array, segments: tuple[slice, ...], where: str) -> RecordClock | None:
    """The clock of even stamps, exact or rounded; None where the stamps are uneven."""
    period = _least_squares_period(stamps, segments)
    if period is None or not _is_even(stamps, segments, period):
        return None
    time = np.empty_like(stamps)
    for segment in segments:
        index = np.arange(segment.stop - segment.start)
        start = np.mean(stamps[segment] - period * index)
        time[segment] = start + period * index
    check_duration(len(stamps), period, where)
    rows = np.arange(len(stamps))
    jitter = float(np.sqrt(np.mean((stamps - time) ** 2)))
    return RecordClock(rows, stamps, rows, time, period, segments, segments, jitter=jitter)


def _least_squares_period(stamps: Array, segments: Sequence[slice]) -> float | None:
    above = below = 0.0
    for segment in segments:
        index = np.arange(segment.stop - segment.start, dtype=np.float64)
        index -= index.mean()
        above += float(index @ (stamps[segment] - stamps[segment.start]))
        below += float(index @ index)
    if below == 0 or not math.isfinite(above) or above <= 0:
        return None
    # rounded to 12 digits, finer than the error of any clock: 0.001 stays 0.001
    return float(f"{above / below:.12g}")


def _is_even(stamps: Array, segments: Sequence[slice], period: float) -> bool:
    steps = np.diff(stamps)
    within = np.ones(len(steps), dtype=bool)
    within[[segment.start - 1 for segment in segments[1:]]] = False
    if not within.any():
        return False
    # a step that occurs, no mean of two
    usual = float(np.quantile(steps[within], 0.5, method="higher"))
    steps = np.where(within, steps, usual)
    if np.all(np.abs(steps - usual) <= _JITTER * usual):
        return True
    return abs(period - usual) > _EQUAL * usual and is_only_rounded(stamps, segments, period)


def is_only_rounded(stamps: Array, segments: Sequence[slice], period: float) -> bool:
    """Whether steps differ only by rounding: each stamp is next to its place on a uniform grid."""
    allowed = (0.5 + 1e-3) * _resolution(stamps) + _JITTER * period
    for segment in segments:
        deviation = stamps[segment] - period * np.arange(segment.stop - segment.start)
        if np.max(np.abs(deviation - deviation.mean())) > allowed:
            return False
    return True


def _resolution(stamps: Array) -> float:
    """Power of ten in seconds to which the stamps are rounded; 1e-9 s if they are finer."""
    some = stamps[:1000] - stamps[0]
    for digits in range(9):
        if np.all(np.abs(some - np.round(some, digits)) < 1e-3 * 10.0**-digits):
            return 10.0**-digits
    return 1e-9

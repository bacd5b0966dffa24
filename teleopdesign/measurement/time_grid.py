"""The time axis of a record: one sample time, and stretches without interruption."""

import math

import numpy as np
from numpy.typing import NDArray

from ..errors import ExperimentError

Array = NDArray[np.float64]

_JITTER = 0.2  # of a sample time: a step may be that much longer or shorter than the others
_EQUAL = 0.02  # mean and usual step closer than this: rare odd steps are lost samples, not rounding
_GAP = 1.5  # sample times: a longer step means that samples are missing
_SHORTEST = 1.0  # s, all segments of a record together
_FEWEST = 64  # samples


def segments_of(labels: Array | None, count: int) -> tuple[slice, ...]:
    """Stretches of consecutive samples: a new one wherever the label changes."""
    if labels is None:
        return (slice(0, count),)
    starts = [0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), count]
    return tuple(slice(a, b) for a, b in zip(starts, starts[1:], strict=False))


def uniform_time(
    stamps: Array, segments: tuple[slice, ...], where: str, *, labelled: bool
) -> tuple[Array, float]:
    """Time on a uniform grid within each segment, shape (n,) in s, and the sample time in s.

    The sample time is the least-squares slope of the stamps over all segments; each segment keeps
    its own start. Stamps may be rounded, and steps may jitter by 20 % of the sample time.
    labelled: the record has a `segment` channel
    raises ExperimentError: a gap, a step back, more jitter (with the row after which it happens)
    """
    _check_size(len(stamps), where)
    period = _least_squares_period(stamps, segments, where)
    _check_steps(stamps, segments, period, where, labelled=labelled)
    time = np.empty_like(stamps)
    for segment in segments:
        index = np.arange(segment.stop - segment.start)
        start = np.mean(stamps[segment] - period * index)
        time[segment] = start + period * index
    _check_duration(len(stamps), period, where)
    return time, period


def counted_time(count: int, rate: float, where: str) -> tuple[Array, float]:
    """Time in s from the sample's number and a rate in Hz, and the sample time in s."""
    _check_size(count, where)
    _check_duration(count, 1 / rate, where)
    return np.arange(count) / rate, 1 / rate


def _least_squares_period(stamps: Array, segments: tuple[slice, ...], where: str) -> float:
    above = below = 0.0
    for segment in segments:
        index = np.arange(segment.stop - segment.start, dtype=np.float64)
        index -= index.mean()
        above += float(index @ (stamps[segment] - stamps[segment.start]))
        below += float(index @ index)
    if below == 0 or not math.isfinite(above):
        raise ExperimentError(
            f"{where}: found no two consecutive samples, expected longer segments"
        )
    if above <= 0:
        raise ExperimentError(
            f"{where}: found time that does not increase, expected increasing time"
        )
    # 12 digits: below any clock's error, and 0.001 stays 0.001
    return float(f"{above / below:.12g}")


def _check_steps(
    stamps: Array, segments: tuple[slice, ...], period: float, where: str, *, labelled: bool
) -> None:
    steps = np.diff(stamps)
    within = np.ones(len(steps), dtype=bool)
    within[[segment.start - 1 for segment in segments[1:]]] = False
    usual = float(np.quantile(steps[within], 0.5, method="higher"))  # one that occurs
    steps = np.where(within, steps, usual)
    if np.all(np.abs(steps - usual) <= _JITTER * usual):
        return
    if abs(period - usual) > _EQUAL * usual and _only_rounded(stamps, segments, period):
        return
    row = int(np.argmax(np.abs(steps - usual)))
    message = f"{where}: row {row + 2}: found a step of {steps[row]:.6g} s"
    if steps[row] < 0:
        raise ExperimentError(f"{message}, expected time that increases by {usual:.6g} s a row")
    if steps[row] > _GAP * usual:
        remedy = "a new value of `segment`" if labelled else "a column `segment` or two records"
        raise ExperimentError(
            f"{message}, expected {usual:.6g} s; where samples are missing, {remedy}"
        )
    raise ExperimentError(
        f"{message}, expected {usual:.6g} s give or take {_JITTER:.0%}; "
        "resample the record to a uniform time"
    )


def _only_rounded(stamps: Array, segments: tuple[slice, ...], period: float) -> bool:
    """Steps differ because stamps are coarse: each is still next to its place on a uniform grid."""
    allowed = (0.5 + 1e-3) * _resolution(stamps) + _JITTER * period
    for segment in segments:
        deviation = stamps[segment] - period * np.arange(segment.stop - segment.start)
        if np.max(np.abs(deviation - deviation.mean())) > allowed:
            return False
    return True


def _resolution(stamps: Array) -> float:
    """Power of ten in seconds that the stamps are rounded to; 1e-9 s if they are finer."""
    some = stamps[:1000] - stamps[0]
    for digits in range(9):
        if np.all(np.abs(some - np.round(some, digits)) < 1e-3 * 10.0**-digits):
            return 10.0**-digits
    return 1e-9


def _check_size(count: int, where: str) -> None:
    if count < _FEWEST:
        raise ExperimentError(f"{where}: found {count} rows, expected at least {_FEWEST}")


def _check_duration(count: int, period: float, where: str) -> None:
    if count * period < _SHORTEST * (1 - 1e-9):
        raise ExperimentError(
            f"{where}: found {count * period:.3g} s of samples, expected at least {_SHORTEST:g} s"
        )

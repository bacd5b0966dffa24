"""The clock of a record: the place of each row of the log on an even time grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError

Array = NDArray[np.float64]
RowNumbers = NDArray[np.intp]
SHORTEST = 1.0  # s: least duration of all segments of a record together
FEWEST = 64  # fewest samples of a record


@dataclass(frozen=True, eq=False)
class RecordClock:
    """The place of each used row of the log on the even grid of a record.

    rows: (m,) used rows of the log, in order;  stamps: (m,) s, of these rows
    places: (m,) nearest sample of the record
    time: (n,) s, even within each segment with step `sample_time`;  segments: of the n samples
    of_rows: the same stretches among the m rows
    exact: each row is one sample at its time, and each sample is a row
    jitter: rms of the stamps about the even clock, s
    dropped, sorted: rows with a repeated stamp, rows out of order
    restarts: times that the clock was set back
    lost: samples without a row, which are filled
    gaps: segments that begin after a pause;  longest_gap: s
    alone: rows with a pause, an end or a clock set back on both sides: they become no sample
    counted: many rows share a stamp, so that rows are counted at the mean rate
    """

    rows: RowNumbers
    stamps: Array
    places: RowNumbers
    time: Array
    sample_time: float
    segments: tuple[slice, ...]
    of_rows: tuple[slice, ...]
    exact: bool = True
    jitter: float = 0.0
    dropped: int = 0
    sorted: int = 0
    restarts: int = 0
    lost: int = 0
    alone: int = 0
    gaps: int = 0
    longest_gap: float = 0.0
    counted: bool = False


def segments_of(labels: Array | None, count: int) -> tuple[slice, ...]:
    """Stretches of consecutive samples: a new stretch wherever the label changes.

    labels: (count,), or None for a single stretch
    """
    if labels is None:
        return (slice(0, count),)
    starts = [0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), count]
    return tuple(slice(a, b) for a, b in zip(starts, starts[1:], strict=False))


def counted_time(count: int, rate: float, where: str) -> tuple[Array, float]:
    """Time in s from the number of each sample and a rate in Hz, and the sample time in s.

    raises ExperimentError: too few rows, or too short
    """
    check_size(count, where)
    check_duration(count, 1 / rate, where)
    return np.arange(count) / rate, 1 / rate


def check_size(count: int, where: str) -> None:
    if count < FEWEST:
        raise ExperimentError(f"{where}: found {count} rows, expected at least {FEWEST}")


def check_duration(count: int, period: float, where: str) -> None:
    if count * period < SHORTEST * (1 - 1e-9):
        raise ExperimentError(
            f"{where}: found {count * period:.3g} s of samples, expected at least {SHORTEST:g} s"
        )

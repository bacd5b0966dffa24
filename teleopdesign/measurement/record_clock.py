"""The clock of a record: a line through the stamps over the places of their rows.

    stamp of a row = start of its stretch + sample time * place of the row + deviation

The places are whole numbers. Where each row follows the one before, they are the numbers of the
rows; a lost row leaves a place empty, and a pause, or a clock that was set back, begins a stretch
with a start of its own. What the line leaves are jitter and rounding. Stamps that follow no such
line are uneven, and those that many rows share only tell the mean rate of the rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError
from .encoder import LOST, Array, is_most
from .reading import count_of
from .row_places import (
    GOES_ON,
    UNEVEN,
    RowNumbers,
    places_of,
    rows_in_order,
    usual_step,
    without_pauses,
)

SHORTEST = 1.0  # s: least duration of all segments of a record together
FEWEST = 64  # fewest samples of a record
#: rms jitter, of a sample time, below which stamps are those of an even clock
EVEN = 0.01
#: s: larger stamps are a date (counted from the year 1970), and the time of the record starts at
#: its first stamp
DATE = 1e8
#: part of the rows that may share a stamp, and by which their mean step may differ from the usual
#: one: with more, the stamps are too coarse to place rows; with less, odd steps are lost rows
FEW = 0.02


@dataclass(frozen=True, eq=False)
class RecordClock:
    """The place of each used row of the log on the even grid of a record.

    rows: (m,) used rows of the log, in order;  stamps: (m,) s, of these rows
    places: (m,) nearest sample of the record
    time: (n,) s, even within each segment with step `sample_time`;  segments: of the n samples
    of_rows: the same stretches among the m rows
    jitter: rms of the stamps about the even clock, s; infinite where they follow none
    set_back: whether the clock was set back
    counted: many rows share a stamp, so that rows are counted at the mean rate
    remarks: what was odd, how it was read, and its effect on the answer
    stamped: whether each row was taken at its stamp; else the rows lie on the even clock
    """

    rows: RowNumbers
    stamps: Array
    places: RowNumbers
    time: Array
    sample_time: float
    segments: tuple[slice, ...]
    of_rows: tuple[slice, ...]
    jitter: float
    set_back: bool = False
    counted: bool = False
    remarks: tuple[tuple[str, str, str], ...] = ()
    stamped: bool = False

    @property
    def exact(self) -> bool:
        """Whether each sample is a row."""
        return np.array_equal(self.places, np.arange(len(self.time)))

    @property
    def lost(self) -> int:
        """Samples of an even clock without a row, which are filled."""
        return 0 if math.isinf(self.jitter) else len(self.time) - len(np.unique(self.places))


def segments_of(labels: Array | None, count: int) -> tuple[slice, ...]:
    """Stretches of consecutive samples: a new stretch wherever the label changes.

    labels: (count,), or None for a single stretch
    """
    if labels is None:
        return (slice(0, count),)
    starts = [0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), count]
    return tuple(slice(a, b) for a, b in zip(starts, starts[1:], strict=False))


def counted_clock(count: int, rate: float, segments: tuple[slice, ...], where: str) -> RecordClock:
    """The clock of rows that follow each other at a rate in Hz.

    raises ExperimentError: too few rows, or too short
    """
    _require_enough(count, 1 / rate, where)
    rows, time = np.arange(count), np.arange(count) / rate
    return RecordClock(rows, time, rows, time, 1 / rate, segments, segments, 0.0)


def clock_of(
    stamps: Array, segments: tuple[slice, ...], same_as_before: NDArray[np.bool_], where: str
) -> RecordClock:
    """The clock of a log.

    stamps: (n,) s, finite, as written;  segments: as labelled in the log
    same_as_before: (n,) the row equals the row before in every channel
    raises ExperimentError: fewer than 64 rows, less than 1 s, time that does not increase
    """
    _require_enough(len(stamps), math.inf, where)
    steps = np.diff(stamps)
    if not np.any(steps > 0) or stamps[-1] < stamps[0] and is_most(steps < 0):
        raise ExperimentError(
            f"{where}: found time that does not increase, expected increasing time"
        )
    pieces = [np.arange(s.start, s.stop) for s in segments]
    period = _step_of_rows_in_a_line([stamps[piece] for piece in pieces])
    if period is not None:
        places = [np.arange(len(piece)) for piece in pieces]
        return _on_grid(stamps, pieces, places, period, where)
    pieces, dropped, moved, restarts = rows_in_order(stamps, segments, same_as_before)
    if dropped > FEW * len(stamps):
        return _clock_of_shared_stamps(stamps, where)
    count, stretches = sum(map(len, pieces)), len(pieces)
    period = usual_step([stamps[piece] for piece in pieces])
    pieces, longest = without_pauses(stamps, pieces, (GOES_ON + 1.5) * period)
    placed = places_of([stamps[piece] for piece in pieces], period)
    if placed is not None:
        period, places = placed
    else:  # no even clock: a grid of as many samples as there are rows
        whole = sum(np.ptp(stamps[p]) for p in pieces)
        period = float(f"{whole / max(count - len(pieces), 1):.12g}")
        places = [np.rint((stamps[p] - stamps[p[0]]) / period).astype(np.intp) for p in pieces]
    clock = _on_grid(
        stamps, pieces, places, period, where, is_even=placed is not None, goes_on=restarts > 0
    )
    remarks = _remarks_on_order(
        dropped=dropped,
        moved=moved,
        restarts=restarts,
        alone=len(stamps) - dropped - len(clock.rows),
        gaps=len(pieces) - stretches,
        longest_gap=longest,
    )
    return replace(clock, set_back=restarts > 0, remarks=tuple(remarks))


def _remarks_on_order(
    *, dropped: int, moved: int, restarts: int, alone: int, gaps: int, longest_gap: float
) -> Iterator[tuple[str, str, str]]:
    """Remarks on repeated stamps, rows out of order, clocks set back, lone rows and pauses (s)."""
    anew = "hidden states start anew at each"
    if dropped:
        text = f"{count_of(dropped, 'row')} with the stamp of another"
        yield text, "the first of each is used", "none"
    if moved:
        yield f"{count_of(moved, 'row')} out of order", "sorted by their stamps", "none"
    if restarts:
        yield f"time set back {count_of(restarts, 'time')}", "a new segment each time", anew
    if alone:
        text = f"{count_of(alone, 'row')} with a pause or an end on both sides"
        yield text, "left out: one row tells no motion", "none"
    if gaps > 0:
        text = f"{count_of(gaps, 'pause')}, the longest {longest_gap:.3g} s"
        yield text, "a new segment after each", anew


def _require_enough(count: int, period: float, where: str) -> None:
    if count < FEWEST:
        raise ExperimentError(f"{where}: found {count} rows, expected at least {FEWEST}")
    if count * period < SHORTEST * (1 - LOST):
        raise ExperimentError(
            f"{where}: found {count * period:.3g} s of samples, expected at least {SHORTEST:g} s"
        )


def _step_of_rows_in_a_line(pieces: Sequence[Array]) -> float | None:
    """Sample time (s) where each row follows the one before, by least squares; None: else.

    pieces: stamps of each stretch
    """
    above = below = 0.0
    for stamps in pieces:
        index = np.arange(len(stamps)) - 0.5 * (len(stamps) - 1)
        above += float(index @ (stamps - stamps[0]))
        below += float(index @ index)
    if below == 0 or not math.isfinite(above) or above <= 0:
        return None
    # rounded to 12 digits, finer than the error of any clock: 0.001 stays 0.001
    period = float(f"{above / below:.12g}")
    steps = np.concatenate([np.diff(stamps) for stamps in pieces])
    usual = float(np.quantile(steps, 0.5, method="higher"))  # a step that occurs, no mean of two
    if np.all(np.abs(steps - usual) <= UNEVEN * usual):
        return period
    if abs(period - usual) <= FEW * usual:
        return None
    # steps that differ only by rounding: each stamp is next to its place
    allowed = (0.5 + 1e-3) * _resolution(np.concatenate(pieces)) + UNEVEN * period
    off = [stamps - period * np.arange(len(stamps)) for stamps in pieces]
    return period if max(np.max(np.abs(x - x.mean())) for x in off) <= allowed else None


def _resolution(stamps: Array) -> float:
    """Power of ten in seconds to which the stamps are rounded; 1e-9 s if they are finer."""
    some = stamps[:1000] - stamps[0]
    digits = (10.0**-n for n in range(9))
    return next(
        (d for d in digits if np.all(np.abs(some - d * np.round(some / d)) < 1e-3 * d)), 1e-9
    )


def _on_grid(
    stamps: Array,
    pieces: Sequence[RowNumbers],
    places: Sequence[RowNumbers],
    period: float,
    where: str,
    *,
    is_even: bool = True,
    goes_on: bool = False,
) -> RecordClock:
    """The clock of rows whose places in each stretch are known.

    is_even: the stamps follow an even clock, whose phase is their mean
    goes_on: a clock that was set back continues where the stretch before it ended
    """
    time: list[Array] = []
    index: list[RowNumbers] = []
    segments: list[slice] = []
    of_rows: list[slice] = []
    first = row = 0
    end = -math.inf
    for piece, place in zip(pieces, places, strict=True):
        length = int(place[-1]) + 1
        start = float(np.mean(stamps[piece] - period * place) if is_even else stamps[piece[0]])
        start = max(start, end + period) if goes_on else start
        time.append(np.asarray(start + period * np.arange(length), dtype=np.float64))
        end = float(time[-1][-1])
        index.append(first + place)
        segments.append(slice(first, first + length))
        of_rows.append(slice(row, row + len(piece)))
        first, row = first + length, row + len(piece)
    rows, at, whole = np.concatenate(pieces), np.concatenate(index), np.concatenate(time)
    _require_enough(len(whole), period, where)
    off = stamps[rows] - whole[at]
    for stretch in of_rows:  # its clock may have been set
        off[stretch] -= off[stretch].mean()
    return RecordClock(
        rows,
        stamps[rows],
        at,
        whole,
        period,
        tuple(segments),
        tuple(of_rows),
        jitter=float(np.sqrt(np.mean(off**2))) if is_even else math.inf,
    )


def _clock_of_shared_stamps(stamps: Array, where: str) -> RecordClock:
    """Rows at the mean rate between the first and the last change of a stamp.

    The rows before the first change and after the last one share a stamp with rows that the log, or
    its span, does not hold: over the whole log, whole seconds would give a wrong rate.
    """
    count = len(stamps)
    changes = np.flatnonzero(np.diff(stamps) > 0) + 1
    first, last = (changes[0], changes[-1]) if len(changes) > 1 else (0, count - 1)
    period = float(f"{(stamps[last] - stamps[first]) / (last - first):.12g}")
    clock = counted_clock(count, 1 / period, (slice(0, count),), where)
    time = stamps[first] + period * (clock.rows - first)
    why = (
        "stamps that many rows share",
        "rows are counted at the mean rate",
        "lost rows cannot be seen in such stamps",
    )
    return replace(clock, stamps=time, time=time, sample_time=period, counted=True, remarks=(why,))

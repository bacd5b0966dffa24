"""The clock of a record: one line through the stamps of its rows.

    stamp of a row = start of its stretch + sample time * place of the row + deviation

The places are whole numbers. A lost row leaves a place empty; a pause, or a clock that was set
back, begins a stretch with a start of its own. Where each step between two stamps is near a whole
number of usual steps, these tell the places, however far the clock drifts. Else the line does that
leaves least. What it leaves are jitter and rounding. Stamps that follow no such line are uneven,
and those that many rows share only tell the mean rate of the rows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError
from .encoder import LOST, Array, is_most
from .limits import FEWEST, HALF, SHORTEST
from .reading import count_of
from .stamps import GOES_ON, are_set_back, usual_step

RowNumbers = NDArray[np.intp]

#: rms jitter, of a sample time, below which stamps are those of an even clock
EVEN = 0.01
#: s: larger stamps are a date (counted from the year 1970), and the time of the record starts at
#: its first stamp
DATE = 1e8
#: part of the rows that may share a stamp; of more, each is a reading of its own
FEW = 0.02
#: part of a sample time by which each step may be off, or stamps off their places (rms): random
#: stamps have 0.29
UNEVEN = 0.2


@dataclass(frozen=True, eq=False)
class RecordClock:
    """The place of each used row of the log on the even grid of a record.

    rows: (m,) used rows of the log, in order;  stamps: (m,) s, of these rows
    places: (m,) nearest sample of the record
    time: (n,) s, even within each segment with step `sample_time` (s);  segments: of the n samples
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


def clock_of(stamps: Array, segments: Sequence[slice], where: str) -> RecordClock:
    """The clock of a log.

    stamps: (n,) s, finite, as written;  segments: as labelled in the log
    raises ExperimentError: fewer than 64 rows, less than 1 s, time that does not increase
    """
    _require_enough(len(stamps), math.inf, where)
    steps = np.diff(stamps)
    if not np.any(steps > 0) or stamps[-1] < stamps[0] and is_most(steps < 0):
        raise ExperimentError(
            f"{where}: found time that does not increase, expected increasing time"
        )
    usual, anew = usual_step(steps), "hidden states start anew at each"
    written = [np.arange(s.start, s.stop) for s in segments]
    parts = _cut(written, lambda p: are_set_back(np.diff(stamps[p]), usual))
    restarts = len(parts) - len(written)
    in_order = [part[np.argsort(stamps[part], kind="stable")] for part in parts]
    moved = sum(int(np.sum(a != b)) for a, b in zip(in_order, parts, strict=True))
    once = [p[np.diff(stamps[p], prepend=-math.inf) > 0.0] for p in in_order]
    dropped = len(stamps) - sum(map(len, once))
    if dropped > FEW * len(stamps):
        return _clock_of_shared_stamps(stamps, where)
    once = [part for part in once if len(part) > 1]
    between = np.concatenate([np.diff(stamps[part]) for part in once])
    pause = (GOES_ON + 1.5) * usual_step(between)
    pieces = [p for p in _cut(once, lambda p: np.diff(stamps[p]) > pause) if len(p) > 1]
    clock = _clock_of_stretches(stamps, pieces, where, goes_on=restarts > 0)
    alone, gaps = len(stamps) - dropped - len(clock.rows), len(pieces) - len(once)
    remarks = (
        (dropped, "row", " with the stamp of another", "the first of each is used", "none"),
        (moved, "row", " out of order", "sorted by their stamps", "none"),
        (restarts, "time", "", "a new segment each time", anew),
        (alone, "row", " with a pause or an end on both sides", "left out: one row tells no motion",
         "none"),
        (gaps, "pause", f", the longest {between.max():.3g} s", "a new segment after each", anew),
    )  # fmt: skip
    shown = (
        (f"{'time set back ' * (noun == 'time')}{count_of(n, noun)}{more}", rule, effect)
        for n, noun, more, rule, effect in remarks
        if n > 0
    )
    return replace(clock, set_back=restarts > 0, remarks=tuple(shown))


def _cut(
    parts: Sequence[RowNumbers], is_cut: Callable[[RowNumbers], NDArray[np.bool_]]
) -> list[RowNumbers]:
    """The rows of each part, parted at some of the steps between them."""
    return [p for part in parts for p in np.split(part, np.flatnonzero(is_cut(part)) + 1)]


def _require_enough(count: int, period: float, where: str) -> None:
    if count < FEWEST:
        raise ExperimentError(f"{where}: found {count} rows, expected at least {FEWEST}")
    if count * period < SHORTEST * (1 - LOST):
        raise ExperimentError(
            f"{where}: found {count * period:.3g} s of samples, expected at least {SHORTEST:g} s"
        )


def places_of(pieces: Sequence[Array]) -> list[RowNumbers] | None:
    """The places of rows on an even clock, in each stretch from 0; None: they follow no such clock.

    pieces: stamps (m,) of each stretch, rising
    """
    steps = np.concatenate([np.diff(stamps) for stamps in pieces])
    usual = usual_step(steps)
    if np.all((np.abs(steps / usual - np.rint(steps / usual)) <= UNEVEN) & (steps > HALF * usual)):
        return [
            np.cumsum(np.rint(np.diff(stamps, prepend=stamps[0]) / usual)).astype(np.intp)
            for stamps in pieces
        ]
    # coarse stamps: no step is the usual one
    fits = [fit for step in (usual, float(np.mean(steps))) if (fit := _line_through(pieces, step))]
    off, places = min(fits, key=lambda fit: fit[0], default=(math.inf, []))
    return places if off <= UNEVEN else None


def _line_through(pieces: Sequence[Array], step: float) -> tuple[float, list[RowNumbers]] | None:
    """Rms distance from an even clock of about this step, in steps, and the places on it.

    None: two rows have one place
    """
    longest = max(pieces, key=len)
    start, count = float(longest[0]), FEWEST
    while True:  # from few rows to all
        some = longest[:count]
        place = np.rint((some - start) / step)
        if place[-1] < 1:
            return None
        step, start = map(float, np.polyfit(place, some, 1))
        if count >= len(longest):
            break
        count *= 2
    places, squares = [], 0.0
    for stamps in pieces:
        since = (stamps - stamps[0]) / step
        # the phase of a stretch: the circular mean of its stamps
        since -= float(np.angle(np.exp(2j * np.pi * since).mean()) / (2 * np.pi))
        # a row that is late by half a row or more remains before the next row
        number = np.arange(len(stamps))
        place = np.minimum.accumulate((np.rint(since) - number)[::-1])[::-1] + number
        squares += float(np.sum((since - place) ** 2))
        places.append((place - place[0]).astype(np.intp))
    return math.sqrt(squares / sum(map(len, pieces))), places


def slope_of(pieces: Sequence[Array], places: Sequence[RowNumbers]) -> float:
    """Sample time (s) of one even clock through the stamps of all stretches, by least squares."""
    centred = [place - place.mean() for place in places]
    above = sum(float(c @ (s - s[0])) for c, s in zip(centred, pieces, strict=True))
    # rounded to 12 digits, finer than the error of any clock: 0.001 stays 0.001
    return float(f"{above / sum(float(c @ c) for c in centred):.12g}")


def _clock_of_stretches(
    stamps: Array, pieces: Sequence[RowNumbers], where: str, *, goes_on: bool
) -> RecordClock:
    """The clock of rows in order, in stretches without a pause.

    goes_on: a clock that was set back continues where the stretch before it ended
    """
    of_each = [stamps[piece] for piece in pieces]
    placed = places_of(of_each)
    if placed is not None:
        places, period = placed, slope_of(of_each, placed)
    else:  # no even clock: a grid of as many samples as there are rows
        period = float(f"{np.mean(np.concatenate([np.diff(s) for s in of_each])):.12g}")
        places = [np.rint((s - s[0]) / period).astype(np.intp) for s in of_each]
    time: list[Array] = []
    end = -math.inf
    for s, place in zip(of_each, places, strict=True):
        # the phase of an even clock is the mean of its stamps
        start = float(np.mean(s - period * place)) if placed is not None else float(s[0])
        start = max(start, end + period) if goes_on else start
        time.append(start + period * np.arange(place[-1] + 1, dtype=np.float64))
        end = float(time[-1][-1])
    segments, of_rows = _slices(map(len, time)), _slices(map(len, pieces))
    at = np.concatenate([s.start + place for s, place in zip(segments, places, strict=True)])
    rows, whole = np.concatenate(pieces), np.concatenate(time)
    _require_enough(len(whole), period, where)
    off = stamps[rows] - whole[at]
    for stretch in of_rows:  # its clock may have been set
        off[stretch] -= off[stretch].mean()
    jitter = math.inf if placed is None else float(np.sqrt(np.mean(off**2)))
    return RecordClock(rows, stamps[rows], at, whole, period, segments, of_rows, jitter)


def _slices(lengths: Iterable[int]) -> tuple[slice, ...]:
    """Slices of these lengths, one after the other."""
    ends = [0, *accumulate(lengths)]
    return tuple(slice(a, b) for a, b in zip(ends, ends[1:], strict=False))


def _clock_of_shared_stamps(stamps: Array, where: str) -> RecordClock:
    """Rows at the rate of the line through the first row of each stamp but the first one.

    The rows before the first change share a stamp with rows that the log, or its span, does not
    hold: over the whole log, whole seconds would give a wrong rate.
    """
    count = len(stamps)
    changes = np.flatnonzero(np.diff(stamps) > 0) + 1
    first = changes if len(changes) > 1 else np.array([0, count - 1])
    period = slope_of([stamps[first]], [first])
    clock = counted_clock(count, 1 / period, (slice(0, count),), where)
    time = np.mean(stamps[first] - period * first) + np.arange(count) * period
    why = (
        "stamps that many rows share",
        "rows are counted at the mean rate",
        "lost rows cannot be seen in such stamps",
    )
    return replace(clock, stamps=time, time=time, sample_time=period, counted=True, remarks=(why,))


@dataclass(frozen=True)
class LoggerClock:
    """Prior knowledge of the clock of a logger; `CLOCK` is in use."""

    #: samples, standard deviation of a shift: twice this is one row. Lower: a delay of less than a
    #: row is called physics; higher: what a shift imitates is left open
    spread: float = 0.5
    #: samples by which a command may be logged early: one row, and a tenth for errors of an
    #: estimate. More is a delay
    early: float = 1.1
    #: s by which the log of a force may be late where that is more: what a low-pass of 15 Hz passes
    #: is 11 ms late, buffers of a logger are a few rows. Lower: they are called a compliance;
    #: higher: a compliance with large damping is called a late log
    latest: float = 0.05
    #: s, standard deviation of the shift of a measured force where it is more: sensors filter
    sensor_spread: float = 0.005
    #: part of its bound from which a shift counts as at the bound: far nearer than a standard error
    near: float = 0.999
    #: rows and standard errors from which a command that acts late is said to be like a delay
    reported_rows: float = 0.1
    reported_errors: float = 2.0


#: prior knowledge of the clock of a log
CLOCK = LoggerClock()

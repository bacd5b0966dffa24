"""The time axis of a record: from the stamps of a log to one sample time, in stretches.

Stamps on an even clock are used as they are. Where rows are missing, out of order or twice, where
the log pauses, and where stamps are uneven, `clock_of` says which row stands where: nothing has to
be mended in the file. Whether uneven stamps tell when a sample was taken, or only when it was
written down, the position tells (`stamps_are_true`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import ExperimentError

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

_JITTER = 0.2  # of a sample time: a step may be that much longer or shorter than the others
_EQUAL = 0.02  # mean and usual step closer than this: rare odd steps are lost samples, not rounding
_SHORTEST = 1.0  # s, all segments of a record together
_FEWEST = 64  # samples
#: lost rows in a row that are filled; more of them part the record. At 1 kHz six sample times are a
#: tenth of a period at 16 Hz: what moves in the band of a comparison is still known between them
MOST_FILLED = 5
#: rms jitter, of a sample time, below which stamps are those of an even clock
EVEN = 0.01
#: rms distance of stamps from an even clock, of a sample time, above which they follow none: stamps
#: anywhere would be 0.29 off
NO_CLOCK = 0.2
#: steps back, in sample times, that are rows out of order; longer ones are a clock set anew
OUT_OF_ORDER = 5
#: part of the rows with the stamp of another one above which stamps are too coarse to place rows
TOO_COARSE = 0.02
#: s: stamps above are a date (the year 1970 began at 0), and the record counts from its first one
DATE = 1e8


@dataclass(frozen=True, eq=False)
class RecordClock:
    """Which row of the log stands where on the even grid of a record.

    rows: (m,) rows of the log that are used, in order;  stamps: (m,) s, of these
    places: (m,) sample of the record that the row is next to
    time: (n,) s, even within each segment with step `sample_time`;  segments: of the n samples
    of_rows: the same stretches among the m rows
    exact: every row is a sample, and the other way round, at its time
    jitter: rms of the stamps about the even clock, s;  dropped, sorted, restarts: how many rows
    lost: rows that are filled;  gaps: stretches begun at a pause
    """

    rows: Rows
    stamps: Array
    places: Rows
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
    gaps: int = 0
    longest_gap: float = 0.0
    counted: bool = False


def segments_of(labels: Array | None, count: int) -> tuple[slice, ...]:
    """Stretches of consecutive samples: a new one wherever the label changes."""
    if labels is None:
        return (slice(0, count),)
    starts = [0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), count]
    return tuple(slice(a, b) for a, b in zip(starts, starts[1:], strict=False))


def counted_time(count: int, rate: float, where: str) -> tuple[Array, float]:
    """Time in s from the sample's number and a rate in Hz, and the sample time in s."""
    _check_size(count, where)
    _check_duration(count, 1 / rate, where)
    return np.arange(count) / rate, 1 / rate


def clock_of(
    stamps: Array, segments: tuple[slice, ...], same_as_before: NDArray[np.bool_], where: str
) -> RecordClock:
    """The clock of a log.

    stamps: (n,) s, finite, as written;  segments: as labelled in the log
    same_as_before: (n,) the row says the same as the row before in every channel
    raises ExperimentError: fewer than 64 rows, less than 1 s, time that does not increase
    """
    count = len(stamps)
    _check_size(count, where)
    if not np.any(np.diff(stamps) > 0) or stamps[-1] < stamps[0] and _mostly_back(stamps):
        raise ExperimentError(
            f"{where}: found time that does not increase, expected increasing time"
        )
    even = _even_clock(stamps, segments, where)
    if even is not None:
        return even
    parts, dropped, moved, restarts = _in_order(stamps, segments, same_as_before)
    return _sparse_clock(stamps, parts, (dropped, moved, restarts), len(segments), where)


def _mostly_back(stamps: Array) -> bool:
    return float(np.mean(np.diff(stamps) < 0)) > 0.5


def _even_clock(stamps: Array, segments: tuple[slice, ...], where: str) -> RecordClock | None:
    """The clock where stamps are even, or even and rounded; None where they are neither."""
    period = _least_squares_period(stamps, segments)
    if period is None or not _is_even(stamps, segments, period):
        return None
    time = np.empty_like(stamps)
    for segment in segments:
        index = np.arange(segment.stop - segment.start)
        start = np.mean(stamps[segment] - period * index)
        time[segment] = start + period * index
    _check_duration(len(stamps), period, where)
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
    # 12 digits: below any clock's error, and 0.001 stays 0.001
    return float(f"{above / below:.12g}")


def _is_even(stamps: Array, segments: Sequence[slice], period: float) -> bool:
    steps = np.diff(stamps)
    within = np.ones(len(steps), dtype=bool)
    within[[segment.start - 1 for segment in segments[1:]]] = False
    if not within.any():
        return False
    usual = float(np.quantile(steps[within], 0.5, method="higher"))  # one that occurs
    steps = np.where(within, steps, usual)
    if np.all(np.abs(steps - usual) <= _JITTER * usual):
        return True
    return abs(period - usual) > _EQUAL * usual and only_rounded(stamps, segments, period)


def only_rounded(stamps: Array, segments: Sequence[slice], period: float) -> bool:
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


def _in_order(
    stamps: Array, segments: Sequence[slice], same_as_before: NDArray[np.bool_]
) -> tuple[list[Rows], int, int, int]:
    """Rows of each stretch in the order of their stamps, each stamp once.

    returns: the stretches, and how many rows were dropped, moved, and began a new clock
    """
    forward = np.diff(stamps)
    usual = float(np.median(forward[forward > 0]))
    parts: list[Rows] = []
    dropped = moved = restarts = 0
    for segment in segments:
        rows = np.arange(segment.start, segment.stop)
        back = np.flatnonzero(np.diff(stamps[rows]) < -(OUT_OF_ORDER + 0.5) * usual) + 1
        restarts += len(back)
        for part in np.split(rows, back):
            order = np.argsort(stamps[part], kind="stable")
            moved += int(np.sum(order != np.arange(len(part))))
            part = part[order]
            again = np.r_[False, np.diff(stamps[part]) <= 0]
            # a stamp may differ by rounding from its repeat: a row that says the same far too early
            early = np.r_[False, np.diff(stamps[part]) < 0.25 * usual] & same_as_before[part]
            dropped += int(np.sum(again | early))
            parts.append(part[~(again | early)])
    return [part for part in parts if len(part) > 1], dropped, moved, restarts


def _sparse_clock(
    stamps: Array, parts: list[Rows], changes: tuple[int, int, int], labelled: int, where: str
) -> RecordClock:
    """The clock of stamps with steps of any length, ascending in each part."""
    dropped, moved, restarts = changes
    count = sum(map(len, parts))
    if dropped > TOO_COARSE * len(stamps):
        # stamps that many rows share cannot place them: rows are counted at the mean rate
        return _counted_clock(stamps, where)
    period = _usual_step([stamps[part] for part in parts])
    pieces: list[Rows] = []
    longest = 0.0
    for part in parts:
        steps = np.diff(stamps[part])
        pauses = np.flatnonzero(steps > (MOST_FILLED + 1.5) * period) + 1
        longest = max(longest, float(steps[pauses - 1].max(initial=0.0)))
        pieces += [piece for piece in np.split(part, pauses) if len(piece) > 1]
    gaps = max(0, len(pieces) - len(parts))
    placed = _places([stamps[piece] for piece in pieces], period)
    if placed is not None:
        period, places = placed
    else:
        # no even clock: a grid of as many samples as there are rows
        period = float(
            f"{sum(np.ptp(stamps[p]) for p in pieces) / max(count - len(pieces), 1):.12g}"
        )
        places = [np.rint((stamps[p] - stamps[p[0]]) / period).astype(np.intp) for p in pieces]
    rows = np.concatenate(pieces)
    on_clock = placed is not None
    time, index, segments, of_rows = _grid_of(
        stamps, pieces, places, period, on_clock=on_clock, goes_on=bool(restarts)
    )
    whole = np.concatenate(time)
    places_of_rows = np.concatenate(index)
    _check_size(len(whole), where)
    _check_duration(len(whole), period, where)
    off = _off_clock(stamps[rows], whole[places_of_rows], of_rows)
    return RecordClock(
        rows=rows,
        stamps=stamps[rows],
        places=places_of_rows,
        time=whole,
        sample_time=period,
        segments=tuple(segments),
        of_rows=tuple(of_rows),
        exact=False,
        jitter=float(np.sqrt(np.mean(off**2))) if placed is not None else math.inf,
        dropped=dropped,
        sorted=moved,
        restarts=restarts,
        lost=len(whole) - len(np.unique(places_of_rows)) if placed is not None else 0,
        gaps=gaps,
        longest_gap=longest,
    )


def _grid_of(
    stamps: Array,
    pieces: Sequence[Rows],
    places: Sequence[Rows],
    period: float,
    *,
    on_clock: bool,
    goes_on: bool,
) -> tuple[list[Array], list[Rows], list[slice], list[slice]]:
    """Even time and places of each piece, and where it lies among samples and rows.

    on_clock: the stamps follow an even clock, whose phase is their mean
    goes_on: a clock that was set back goes on where the stretch before it ended
    """
    time: list[Array] = []
    index: list[Rows] = []
    segments: list[slice] = []
    of_rows: list[slice] = []
    first = row = 0
    end = -math.inf
    for piece, place in zip(pieces, places, strict=True):
        length = int(place[-1]) + 1
        start = float(np.mean(stamps[piece] - period * place) if on_clock else stamps[piece[0]])
        start = max(start, end + period) if goes_on else start
        time.append(np.asarray(start + period * np.arange(length), dtype=np.float64))
        end = float(time[-1][-1])
        index.append(first + place)
        segments.append(slice(first, first + length))
        of_rows.append(slice(row, row + len(piece)))
        first, row = first + length, row + len(piece)
    return time, index, segments, of_rows


def _off_clock(stamps: Array, time: Array, stretches: Sequence[slice]) -> Array:
    """Stamps less the even time, each stretch about its own mean: its clock may have been set."""
    off = stamps - time
    for stretch in stretches:
        off[stretch] -= off[stretch].mean()
    return off


def _counted_clock(stamps: Array, where: str) -> RecordClock:
    count = len(stamps)
    period = float(f"{(stamps.max() - stamps.min()) / (count - 1):.12g}")
    _check_duration(count, period, where)
    rows, whole = np.arange(count), (slice(0, count),)
    time = stamps.min() + period * rows
    return RecordClock(rows, time, rows, time, period, whole, whole, counted=True)


def _usual_step(pieces: Sequence[Array]) -> float:
    """The step between neighbouring rows, s: that of the rows that follow each other at once."""
    steps = np.concatenate([np.diff(piece) for piece in pieces])
    usual = float(np.median(steps))
    near = steps[np.abs(steps - usual) < 0.5 * usual]
    return float(near.mean()) if len(near) else usual


def _places(pieces: Sequence[Array], period: float) -> tuple[float, list[Rows]] | None:
    """An even clock through stretches of stamps with rows missing: its step, s, and the places.

    None: the stamps follow no even clock (rms distance above `NO_CLOCK`, or two rows on one place)
    """
    longest = max(pieces, key=len)
    fit = _line_through(longest, period)
    if fit is None:
        return None
    period = fit
    places: list[Rows] = []
    for stamps in pieces:
        steps = np.diff(stamps) / period
        # the phase of a stretch: the circular mean of its stamps
        turns = np.exp(2j * np.pi * (stamps - stamps[0]) / period)
        phase = float(np.angle(turns.mean()) / (2 * np.pi))
        place = np.rint((stamps - stamps[0]) / period - phase)
        off = (stamps - stamps[0]) / period - phase - place
        if np.sqrt(np.mean(off**2)) > NO_CLOCK or np.any(np.diff(place) < 1) or steps.max() > 1e6:
            return None
        places.append((place - place[0]).astype(np.intp))
    return period, places


def _line_through(stamps: Array, period: float) -> float | None:
    """Step of the even clock through one stretch, from few rows to all: s."""
    start, count = float(stamps[0]), min(64, len(stamps))
    while True:
        some = stamps[:count]
        place = np.rint((some - start) / period)
        if place[-1] < 1:
            return None
        slope, start = np.polyfit(place, some, 1)
        if not math.isfinite(slope) or not 0.5 * period < slope < 2.0 * period:
            return None
        period = float(slope)
        if count == len(stamps):
            return float(f"{period:.12g}")
        count = min(2 * count, len(stamps))


def stamps_are_true(clock: RecordClock, positions: Sequence[Array]) -> tuple[float, float]:
    """Whether a position moved as long as the stamps say: 1, or a row as its neighbours: 0.

    What a reading lies off its neighbours is regressed on speed times what the stamp lies off the
    even clock, both as second differences, which a smooth motion does not pass.
    positions: (m,) each, of the clock's rows
    returns: the coefficient and its standard error; (1, inf) where no position tells
    """
    above = below = 0.0
    pairs: list[tuple[Array, Array]] = []
    off = clock.stamps - clock.time[clock.places]
    for stretch in clock.of_rows:
        place = clock.places[stretch]
        if len(place) < 5:
            continue
        inner = (place[2:] - place[:-2] == 2)[1:-1]
        late = off[stretch] - off[stretch].mean()
        for x in positions:
            x = x[stretch]
            speed = np.zeros(len(x))
            speed[1:-1] = (x[2:] - x[:-2]) / (2.0 * clock.sample_time)
            bend = np.diff(x, 2)[1:-1][inner]
            made = np.diff(speed * late, 2)[1:-1][inner]
            scale = float(np.mean(bend**2))
            if scale > 0 and len(bend):
                above += float(made @ bend) / scale
                below += float(made @ made) / scale
                pairs.append((bend / math.sqrt(scale), made / math.sqrt(scale)))
    if below <= 0:
        return 1.0, math.inf
    slope = above / below
    left = sum(float(np.sum((b - slope * m) ** 2)) for b, m in pairs)
    number = sum(len(b) for b, _ in pairs)
    # neighbouring second differences share readings: six samples' worth count as one
    return slope, math.sqrt(6.0 * left / max(number, 1) / below)


def _check_size(count: int, where: str) -> None:
    if count < _FEWEST:
        raise ExperimentError(f"{where}: found {count} rows, expected at least {_FEWEST}")


def _check_duration(count: int, period: float, where: str) -> None:
    if count * period < _SHORTEST * (1 - 1e-9):
        raise ExperimentError(
            f"{where}: found {count * period:.3g} s of samples, expected at least {_SHORTEST:g} s"
        )

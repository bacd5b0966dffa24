"""Uneven time stamps: lost, repeated or exchanged rows, pauses, no even clock."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .record_clock import Array, RecordClock, RowNumbers, check_duration, check_size

#: most successive lost rows that are filled; with more, the record is split. At 1 kHz six sample
#: times are a tenth of a period at 16 Hz, so the motion between them is still known in the band of
#: a comparison
MOST_FILLED = 5
#: rms distance of stamps from an even clock, in sample times, above which they follow no even
#: clock: random stamps have 0.29
NO_CLOCK = 0.2
#: longest step back, in sample times, that is a row out of order; a longer one is a clock that was
#: set back
OUT_OF_ORDER = 5
#: if more than this part of the rows have the stamp of another row, stamps are too coarse to place
#: rows
TOO_COARSE = 0.02


def rows_in_order(
    stamps: Array, segments: Sequence[slice], same_as_before: NDArray[np.bool_]
) -> tuple[list[RowNumbers], int, int, int]:
    """Rows of each stretch in the order of their stamps, each stamp once.

    returns: the rows of the stretches, and the numbers of dropped rows, moved rows and set-back
        clocks
    """
    forward = np.diff(stamps)
    usual = float(np.median(forward[forward > 0]))
    parts: list[RowNumbers] = []
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
            # stamps of a repeated row may differ by rounding: an equal row far too early is one
            early = np.r_[False, np.diff(stamps[part]) < 0.25 * usual] & same_as_before[part]
            dropped += int(np.sum(again | early))
            parts.append(part[~(again | early)])
    return [part for part in parts if len(part) > 1], dropped, moved, restarts


def sparse_clock(
    stamps: Array, parts: list[RowNumbers], changes: tuple[int, int, int], where: str
) -> RecordClock:
    """The clock of stamps that ascend in each part, with steps of any length.

    changes: numbers of dropped rows, moved rows and set-back clocks
    """
    dropped, moved, restarts = changes
    count = sum(map(len, parts))
    if dropped > TOO_COARSE * len(stamps):
        # many rows share a stamp: rows are counted at the mean rate
        return _counted_clock(stamps, where)
    period = _usual_step([stamps[part] for part in parts])
    pieces: list[RowNumbers] = []
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
    check_size(len(whole), where)
    check_duration(len(whole), period, where)
    off = _deviation_from_clock(stamps[rows], whole[places_of_rows], of_rows)
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
        alone=len(stamps) - dropped - len(rows),
        gaps=gaps,
        longest_gap=longest,
    )


def _grid_of(
    stamps: Array,
    pieces: Sequence[RowNumbers],
    places: Sequence[RowNumbers],
    period: float,
    *,
    on_clock: bool,
    goes_on: bool,
) -> tuple[list[Array], list[RowNumbers], list[slice], list[slice]]:
    """Even time and row places of each piece, and the slices of its samples and of its rows.

    on_clock: the stamps follow an even clock, whose phase is their mean
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
        start = float(np.mean(stamps[piece] - period * place) if on_clock else stamps[piece[0]])
        start = max(start, end + period) if goes_on else start
        time.append(np.asarray(start + period * np.arange(length), dtype=np.float64))
        end = float(time[-1][-1])
        index.append(first + place)
        segments.append(slice(first, first + length))
        of_rows.append(slice(row, row + len(piece)))
        first, row = first + length, row + len(piece)
    return time, index, segments, of_rows


def _deviation_from_clock(stamps: Array, time: Array, stretches: Sequence[slice]) -> Array:
    """Stamps minus the even time, minus the mean of each stretch: its clock may have been set."""
    off = stamps - time
    for stretch in stretches:
        off[stretch] -= off[stretch].mean()
    return off


def _counted_clock(stamps: Array, where: str) -> RecordClock:
    """Rows at the mean rate between the first and the last change of a stamp.

    The rows before the first change and after the last one share a stamp with rows that the log, or
    its span, does not hold: over the whole log, whole seconds would give a wrong rate.
    """
    count = len(stamps)
    changes = np.flatnonzero(np.diff(stamps) > 0) + 1
    first, last = (changes[0], changes[-1]) if len(changes) > 1 else (0, count - 1)
    period = float(f"{(stamps[last] - stamps[first]) / (last - first):.12g}")
    check_duration(count, period, where)
    rows, whole = np.arange(count), (slice(0, count),)
    time = stamps[first] + period * (rows - first)
    return RecordClock(rows, time, rows, time, period, whole, whole, counted=True)


def _usual_step(pieces: Sequence[Array]) -> float:
    """Step between neighbouring rows, s: the mean of the steps near the median."""
    steps = np.concatenate([np.diff(piece) for piece in pieces])
    usual = float(np.median(steps))
    near = steps[np.abs(steps - usual) < 0.5 * usual]
    return float(near.mean()) if len(near) else usual


def _places(pieces: Sequence[Array], period: float) -> tuple[float, list[RowNumbers]] | None:
    """Step (s) of an even clock through stretches with missing rows, and the places of the rows.

    None: the stamps follow no even clock (rms distance above `NO_CLOCK`, or two rows on one place)
    """
    longest = max(pieces, key=len)
    fit = _line_through(longest, period)
    if fit is None:
        return None
    period = fit
    places: list[RowNumbers] = []
    for stamps in pieces:
        steps = np.diff(stamps) / period
        # the phase of a stretch: the circular mean of its stamps
        turns = np.exp(2j * np.pi * (stamps - stamps[0]) / period)
        phase = float(np.angle(turns.mean()) / (2 * np.pi))
        place = np.rint((stamps - stamps[0]) / period - phase)
        # a row that is late by half a row or more remains before the next row
        count = np.arange(len(place))
        place = np.minimum.accumulate((place - count)[::-1])[::-1] + count
        off = (stamps - stamps[0]) / period - phase - place
        if np.sqrt(np.mean(off**2)) > NO_CLOCK or np.any(np.diff(place) < 1) or steps.max() > 1e6:
            return None
        places.append((place - place[0]).astype(np.intp))
    return period, places


def _line_through(stamps: Array, period: float) -> float | None:
    """Step (s) of the even clock through one stretch, fitted from few rows to all; or None."""
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

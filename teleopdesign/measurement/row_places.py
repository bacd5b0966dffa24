"""The places of rows on an even clock, where rows are lost, twice or out of order."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .encoder import Array
from .limits import HALF

RowNumbers = NDArray[np.intp]
#: part of a sample time by which steps of an even clock differ, and by which stamps may lie off
#: their places (rms): random stamps have 0.29
UNEVEN = 0.2
#: most successive lost rows that are filled, and most rows by which one is out of order: more are a
#: pause, or a clock that was set back. At 1 kHz six sample times are a tenth of a period at 16 Hz,
#: so the motion between them is still known in the band of a comparison
GOES_ON = 5
#: part of the usual step before which a row that repeats another one is this row again
EARLY = 0.25
#: rows from which a line is fitted first, then through twice as many
FIRST = 64


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
        back = np.flatnonzero(are_set_back(np.diff(stamps[rows]), usual)) + 1
        restarts += len(back)
        for part in np.split(rows, back):
            order = np.argsort(stamps[part], kind="stable")
            moved += int(np.sum(order != np.arange(len(part))))
            part = part[order]
            steps = np.diff(stamps[part], prepend=-math.inf)
            # stamps of a repeated row may differ by rounding: an equal row far too early is one
            again = (steps <= 0) | (steps < EARLY * usual) & same_as_before[part]
            dropped += int(np.sum(again))
            parts.append(part[~again])
    return [part for part in parts if len(part) > 1], dropped, moved, restarts


def are_set_back(steps: Array, usual: float) -> NDArray[np.bool_]:
    """Steps between stamps (n,) at which a clock was set back: further than a row out of order."""
    return np.asarray(steps < -(GOES_ON + 0.5) * usual)


def are_out_of_order(stamps: Array) -> bool:
    """Whether stamps are those of one clock, each once, with rows a little out of order."""
    steps, ordered = np.diff(stamps), np.diff(np.sort(stamps))
    if not np.any(steps < 0) or not np.all(ordered > 0):
        return False
    return not are_set_back(steps, float(np.median(ordered))).any()


def without_pauses(
    stamps: Array, parts: Sequence[RowNumbers], pause: float
) -> tuple[list[RowNumbers], float]:
    """The stretches without pauses that exceed some seconds, and the longest of these pauses."""
    pieces: list[RowNumbers] = []
    longest = 0.0
    for part in parts:
        steps = np.diff(stamps[part])
        longest = max(longest, float(steps.max(initial=0.0, where=steps > pause)))
        cut = np.split(part, np.flatnonzero(steps > pause) + 1)
        pieces += [piece for piece in cut if len(piece) > 1]
    return pieces, longest


def usual_step(pieces: Sequence[Array]) -> float:
    """Step between neighbouring rows, s: the mean of the steps near the median."""
    steps = np.concatenate([np.diff(piece) for piece in pieces])
    usual = float(np.median(steps))
    near = steps[np.abs(steps - usual) < HALF * usual]
    return float(near.mean()) if len(near) else usual


def places_of(pieces: Sequence[Array], period: float) -> tuple[float, list[RowNumbers]] | None:
    """Step (s) of an even clock through stretches with missing rows, and the places of the rows.

    None: the stamps follow no even clock (rms distance above `UNEVEN`, or two rows on one place)
    """
    fit = _line_through(max(pieces, key=len), period)
    if fit is None:
        return None
    places: list[RowNumbers] = []
    for stamps in pieces:
        since = (stamps - stamps[0]) / fit
        # the phase of a stretch: the circular mean of its stamps
        phase = float(np.angle(np.exp(2j * np.pi * since).mean()) / (2 * np.pi))
        place = np.rint(since - phase)
        # a row that is late by half a row or more remains before the next row
        count = np.arange(len(place))
        place = np.minimum.accumulate((place - count)[::-1])[::-1] + count
        off = since - phase - place
        crowded = np.any(np.diff(place) < 1)
        if np.sqrt(np.mean(off**2)) > UNEVEN or crowded:
            return None
        places.append((place - place[0]).astype(np.intp))
    return fit, places


def _line_through(stamps: Array, period: float) -> float | None:
    """Step (s) of the even clock through one stretch, fitted from few rows to all; or None."""
    start, count = float(stamps[0]), min(FIRST, len(stamps))
    while True:
        some = stamps[:count]
        place = np.rint((some - start) / period)
        if place[-1] < 1:
            return None
        slope, start = np.polyfit(place, some, 1)
        period = float(slope)
        if count == len(stamps):
            return float(f"{period:.12g}")
        count = min(2 * count, len(stamps))

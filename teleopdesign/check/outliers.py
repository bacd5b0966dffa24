"""Outliers and jumps: single samples far from their neighbours, and positions that jump.

A sample is an outlier if replacing it by the cubic through its four neighbours removes the
deviation. It is a jump if shifting all later samples does. Steps, impacts and chatter are neither.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from ..base.finding import Finding
from ..measurement.filtering import Array
from ..measurement.limits import HALF
from ..measurement.prepare import FEWEST
from ..measurement.repeated_rows import BY_CHANCE
from ._recording import CheckedRecording, RecordingCheck, Signal

#: an outlier explains its neighbours if their remaining deviation is within EXPLAINED local
#: standard deviations (five errors of this deviation), or within RELATIVE of the outlier
EXPLAINED, RELATIVE = 3.0, 0.2
#: part of the second differences of a position up to which they are usual
USUAL = 0.99
#: of standard deviation 1: scipy's normal law takes longer to import than a log to check
NORMAL = NormalDist()
#: rms of the two statistics for readings rounded to a step: sqrt(70)/6 and sqrt(5) times 0.29
_ROUNDED_LONE, _ROUNDED_JUMP = 0.40, 0.65


def find_odd_samples(recording: CheckedRecording) -> Iterator[Finding]:
    """Outliers of each channel that varies, and jumps of the positions."""
    for signal in recording.varying:
        yield from check_outliers(signal)
        if signal.quantity == "position":
            yield from check_jumps(signal)


CHECK = RecordingCheck(order=20, find=find_odd_samples, in_order="no outliers", may_stop=True)


def check_outliers(signal: Signal) -> Iterator[Finding]:
    """Report outliers of one channel; a sample that only repeats the one before is no outlier."""
    rows: list[NDArray[np.intp]] = []
    sizes: list[Array] = []
    for first, x in signal.stretches:
        at, size = lone_samples(x, signal.rounded_to)
        is_outlier = x[at] != x[at - 1]
        if signal.quantity == "actuator_force":  # a command may have any value within its range
            rest = np.delete(x, at)
            margin = HALF * float(np.ptp(rest))
            is_outlier &= (x[at] > rest.max() + margin) | (x[at] < rest.min() - margin)
        rows.append(at[is_outlier] + first)
        sizes.append(size[is_outlier])
    odd, off = np.concatenate(rows), np.concatenate(sizes)
    if not len(odd):
        return
    worst = int(np.argmax(np.abs(off)))
    row, far = int(odd[worst]), f"{abs(off[worst]):.3g} {signal.unit}"
    what = f": {len(odd)} samples lie off their neighbours' course, the worst by {far}"
    if len(odd) == 1:
        what = f": one sample lies {far} off its neighbours' course"
    time = signal.time(row)
    yield signal.finding(
        "outliers",
        "warning",
        f"{what}, at {time:.6g} s (row {row + 1}): repair or cut it out.",
        {"count": float(len(odd)), "time": time, "row": row + 1.0, "size": float(off[worst])},
        signal.around(row, odd, name="off their neighbours' course"),
    )


def check_jumps(signal: Signal) -> Iterator[Finding]:
    """Report jumps of a position that no body can make: lost samples or counts, wrapped angles."""
    events: list[tuple[int, float, float]] = []
    for first, x in signal.stretches:
        at, size = jumps(x, signal.rounded_to)
        lone, usual = lone_samples(x, signal.rounded_to)[0], _usual_bend(x, at)
        for k, leap in zip(at.tolist(), size.tolist(), strict=True):
            held = x[k] == x[k - 1] or x[k + 1] == x[k + 2]
            if held or abs(leap) < usual or np.any(np.abs(lone - k) <= 2):
                continue
            speed = float(np.mean([x[k] - x[k - 1], x[k + 2] - x[k + 1]]))
            events.append((first + k, leap, leap / speed if speed else np.inf))
    if not events:
        return
    row, leap, lost = max(events, key=lambda event: abs(event[1]))
    times = "once" if len(events) == 1 else f"{len(events)} times"
    why = "no body does that: look at the encoder or the log"
    # an angle wraps by whole turns, within the motion of a sample
    wraps = signal.unit == "rad" and abs(abs(leap) / (2 * np.pi) - 1.0) < 0.05
    if wraps:
        why = "a whole turn: the angle wraps, `unwrap = true` in its channel mends that"
    elif HALF < lost < 1000:
        why = f"as far as it moves in {lost:.0f} samples: if samples are missing, give a `segment` "
        why += "column that changes there"
    time = signal.time(row)
    finding = signal.finding(
        "jumps",
        "warning",
        f" jumps {times}, most at {time:.6g} s (row {row + 1}), by {leap:.4g} {signal.unit}: "
        f"{why}.",
        {"count": float(len(events)), "time": time, "size": leap, "samples": lost},
        signal.around(row, np.array([row, row + 1]), name="before and after the jump"),
    )
    yield replace(finding, stops=wraps)


def lone_samples(x: Array, step: float) -> tuple[NDArray[np.intp], Array]:
    """Indices and sizes of samples that lie off the course of their neighbours.

    x: (n,);  step: smallest step between values
    """
    if len(x) < FEWEST:
        return np.zeros(0, dtype=np.intp), np.zeros(0)
    # x minus the cubic through its four neighbours
    off = np.pad(np.diff(x, 4) / 6.0, 2)
    at, size = _match_events(off, {1: -4.0 / 6.0, 2: 1.0 / 6.0}, _ROUNDED_LONE * step)
    # beside a lone sample both sides agree in level and slope; at a step their levels differ by
    # twice its size, at a kink their slopes by three times
    before, after = 0.5 * (x[at - 1] - x[at - 3]), 0.5 * (x[at + 3] - x[at + 1])
    level = x[at + 1] - x[at - 1] - before - after
    lone = np.maximum(np.abs(level), np.abs(after - before)) < np.abs(size)
    return at[lone], size[lone]


def jumps(x: Array, step: float) -> tuple[NDArray[np.intp], Array]:
    """Indices and sizes of jumps between a sample and the next.

    x: (n,);  step: smallest step between values
    """
    if len(x) < FEWEST:
        return np.zeros(0, dtype=np.intp), np.zeros(0)
    change = np.diff(x)
    leap = np.pad(change[1:-1] - 0.5 * (change[:-2] + change[2:]), 1)
    return _match_events(leap, {1: -0.5}, _ROUNDED_JUMP * step)


def _match_events(
    off: Array, left: dict[int, float], floor: float
) -> tuple[NDArray[np.intp], Array]:
    """Indices where a single event explains a deviation and its neighbours, with the sizes.

    left: shape of the event: distance in samples -> part of its size
    """
    reach, scale = max(left), _local_scale(off, floor)
    # the largest of so many normal values by chance, in standard deviations
    largest = -NORMAL.inv_cdf(0.5 * BY_CHANCE / max(len(off), 1))
    at = np.flatnonzero(np.abs(off) > largest * scale)
    at = at[(at >= 2 * reach) & (at < len(off) - 2 * reach)]
    size = off[at]
    tolerance = np.maximum(EXPLAINED * scale[at], RELATIVE * np.abs(size))
    fits = np.ones(len(at), dtype=bool)
    for distance, part in left.items():
        for side in (-distance, distance):
            fits &= np.abs(off[at + side] - part * size) < tolerance
    return at[fits], size[fits]


def _local_scale(e: Array, floor: float) -> Array:
    """Standard deviation expected of each of n values, from the values nearby; shape (n,).

    The larger of two estimates, from the middle and from the tail of the nearby values, so that a
    signal with heavy tails is judged by its tails. A few outliers do not count.

    floor: least value
    """
    scale = np.full(len(e), max(floor, 1e-300))
    for size, part in ((256, 0.5), (1024, 0.99)):
        size = min(size, len(e))
        count = len(e) // size
        blocks = np.abs(e[: count * size]).reshape(count, size)
        each = np.quantile(blocks, part, axis=1) / NORMAL.inv_cdf(0.5 + 0.5 * part)
        beside = np.pad(each, 1, mode="edge")
        each = np.maximum(np.maximum(beside[:-2], beside[2:]), each)
        scale = np.maximum(scale, each[np.minimum(np.arange(len(e)) // size, count - 1)])
    return scale


def _usual_bend(x: Array, events: NDArray[np.intp]) -> float:
    """Second difference of a position (n,) that few rows exceed, without the rows at events.

    A body that makes such accelerations in other rows can make a leap of that size.
    """
    bend = np.abs(np.diff(x, 2))
    other = np.ones(len(bend), dtype=bool)
    for k in range(-2, 3):
        other[np.clip(events + k, 0, len(bend) - 1)] = False
    return float(np.quantile(bend[other], USUAL)) if other.any() else 0.0

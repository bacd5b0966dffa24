"""Lone samples of a command far off its course, and positions that jump.

Readings of a sensor that are alone far off their course are filled where a log is read. A command
may have any value within its range. A jump is a lone change of a position: it shifts all later
samples, which no body does.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..base.finding import Finding
from ..measurement.limits import HALF, SMALL
from ..measurement.spikes import find_spikes
from ._recording import CheckedRecording, RecordingCheck, Signal


def find_odd_samples(recording: CheckedRecording) -> Iterator[Finding]:
    """Outliers of each command that varies, and jumps of the positions."""
    for signal in recording.varying:
        if signal.quantity == "actuator_force":
            yield from check_outliers(signal)
        if signal.quantity == "position":
            yield from check_jumps(signal)


CHECK = RecordingCheck(order=20, find=find_odd_samples, in_order="no outliers", may_stop=True)


def check_outliers(signal: Signal) -> Iterator[Finding]:
    """Report lone samples of a command that are far out of the range of the others."""
    rows: list[int] = []
    for first, x in signal.stretches:
        odd = find_spikes(x, signal.rounded_to)
        rest = x[~odd]
        margin = HALF * float(np.ptp(rest))
        beyond = (x > rest.max() + margin) | (x < rest.min() - margin)
        rows += (first + np.flatnonzero(odd & beyond)).tolist()
    if not rows:
        return
    row = max(rows, key=lambda k: abs(signal.values[k]))
    count = "one sample lies" if len(rows) == 1 else f"{len(rows)} samples lie"
    time, size = signal.time(row), float(signal.values[row])
    yield signal.finding(
        "outliers",
        "warning",
        f": {count} far out of the range of the others, the largest is {size:.3g} {signal.unit} at "
        f"{time:.6g} s (row {row + 1}): repair or cut it out.",
        {"count": float(len(rows)), "time": time, "row": row + 1.0, "size": size},
        signal.around(row, np.array(rows), name="out of range"),
    )


def check_jumps(signal: Signal) -> Iterator[Finding]:
    """Report jumps of a position that no body can make: lost samples or counts, wrapped angles."""
    events: list[tuple[int, float, float]] = []
    for first, x in signal.stretches:
        change = np.diff(x)
        odd = find_spikes(change, signal.rounded_to)
        alone = odd[1:-1] & ~odd[:-2] & ~odd[2:]  # two in turn are a sample off the course
        for k in (np.flatnonzero(alone) + 1).tolist():
            if change[k - 1] == 0.0 or change[k + 1] == 0.0:  # held, and catching up
                continue
            speed = 0.5 * float(change[k - 1] + change[k + 1])
            leap = float(change[k]) - speed
            events.append((first + k, leap, leap / speed if speed else np.inf))
    if not events:
        return
    row, leap, lost = max(events, key=lambda event: abs(event[1]))
    times = "once" if len(events) == 1 else f"{len(events)} times"
    why = "no body does that: look at the encoder or the log"
    # an angle wraps by whole turns, within the motion of a sample
    wraps = signal.unit == "rad" and abs(abs(leap) / (2 * np.pi) - 1.0) < SMALL
    if wraps:
        why = "a whole turn: the angle wraps, `unwrap = true` in its channel mends that"
    elif HALF < lost < np.inf:
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

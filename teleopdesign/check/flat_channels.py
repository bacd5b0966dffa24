"""Channels that stay at one value where they should change: not connected, stuck, or clipped.

A sine that is sampled often enough rests near its peak, too, and a body may rest at a stop. A
signal counts as clipped only where it arrives with speed, several times, and stops abruptly.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Finding
from ..base.sentences import percent
from ..measurement.encoder import STEPS, reading_noise
from ..measurement.filtering import Array
from ..measurement.limits import HALF, SEVERAL
from ..measurement.repeated_rows import runs_of, stuck_stretches
from ._recording import CheckedRecording, RecordingCheck, Signal


def find_flat_channels(recording: CheckedRecording) -> Iterator[Finding]:
    """Channels that are constant throughout, that stick, or that run flat against a limit."""
    for signal in recording.signals:
        yield from check_constant(signal)
    for signal in recording.varying:
        yield from check_stuck(signal)
        yield from check_clipped(signal)


CHECK = RecordingCheck(order=30, find=find_flat_channels, in_order="no stuck or clipped stretches")


def check_constant(signal: Signal) -> Iterator[Finding]:
    """Report a channel that is constant throughout the record."""
    if np.ptp(signal.values) > 0:
        return
    value = float(signal.values[0])
    why = "not connected, or stuck; leave the channel out if nothing acts"
    if signal.quantity == "actuator_force":
        why = "the command does not change" if value else "the actuator drives nothing"
    elif signal.quantity == "position":
        why = "the body never moves, or the channel is stuck"
    yield signal.finding(
        "stuck channels",
        "note" if signal.quantity == "actuator_force" else "warning",
        f" is {value:.4g} {signal.unit} throughout: {why}.",
        {"value": value},
    )


def check_stuck(signal: Signal) -> Iterator[Finding]:
    """Report stretches in which a channel holds its value while it should change."""
    holds = [
        (first + a, first + b)
        for first, x in signal.stretches
        for a, b in stuck_stretches(x, signal.rounded_to, signal.quantity)
    ]
    if not holds:
        return
    a, b = max(holds, key=lambda hold: hold[1] - hold[0])
    begin, end = signal.time(a), signal.time(b - 1)
    total = sum(q - p for p, q in holds) * signal.record.sample_time
    more = "" if len(holds) == 1 else f" ({len(holds)} times, {total:.3g} s in all)"
    yield signal.finding(
        "stuck channels",
        "warning",
        f" is stuck at {signal.values[a]:.4g} {signal.unit} from {begin:.6g} to {end:.6g} s{more}: "
        "cut that out, with records of the same file and span = [begin, end] before and after it.",
        {"from": begin, "to": end, "duration": total, "count": float(len(holds))},
        signal.around(a, np.arange(a, b), name="stuck"),
    )


def check_clipped(signal: Signal) -> Iterator[Finding]:
    """Report the largest and smallest value of a channel if the signal runs flat against it."""
    noisy = reading_noise(signal.values) > STEPS * signal.rounded_to > 0
    for name, value in (("largest", signal.values.max()), ("smallest", signal.values.min())):
        limit = float(value)
        count = sum(visits(x, limit, signal.rounded_to, noisy=noisy) for _, x in signal.stretches)
        if count < SEVERAL:
            continue
        at = np.flatnonzero(signal.values == value)
        part = len(at) / len(signal.values)
        commanded = signal.quantity == "actuator_force"
        why = "the channel is clipped: cut these out, or record with a larger range"
        if commanded:
            why = "fine if the command itself is limited there, wrong if only the log is"
        yield signal.finding(
            "clipped channels",
            "note" if commanded else "warning",
            f" runs flat against its {name} value {value:.4g} {signal.unit}, {count} times, "
            f"{percent(part, '.2g')} of the samples: {why}.",
            {"value": limit, "count": float(count), "part": part},
            signal.around(int(at[0]), at, name=f"at the {name} value"),
        )


def visits(x: Array, limit: float, step: float, *, noisy: bool) -> int:
    """How often the signal runs into `limit` with speed and stays.

    noisy: readings scatter, so that equal successive readings are unlikely: every stay counts
    """
    first, past = runs_of(x == limit)
    lasting = first[(past - first >= SEVERAL) & (first >= 4)]
    if noisy:
        return len(lasting)
    count = 0
    for row in lasting.tolist():
        coming = np.diff(x[row - 4 : row])  # without the last change, which the limit cuts
        arrived = abs(float(coming[-1]))
        slowing = abs(float(coming[-1] - coming[0])) / 2
        towards = np.all(np.sign(coming) == np.sign(limit - x[row - 1]))
        count += bool(towards and arrived >= STEPS * step and slowing < HALF * arrived)
    return count

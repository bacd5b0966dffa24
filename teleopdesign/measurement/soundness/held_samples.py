"""Held samples: readings that repeat the reading before although the body moves.

Single repeats come from a log that runs faster than its source, long ones from a stuck sensor. A
channel that is constant throughout comes from a wire that is not connected.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from ...base.finding import Finding
from ..encoder import CHANGES, CHANGES_OF_FORCE, update_period
from ..repeated_rows import repeats, stuck_stretches
from .force_steps import LEVELS
from .signal import Signal


def check_constant(signal: Signal) -> list[Finding]:
    """Report a channel that is constant throughout the record."""
    if np.ptp(signal.values) > 0:
        return []
    value = float(signal.values[0])
    concern: Literal["note", "warning"] = "warning"
    if signal.channel.quantity == "actuator_force":
        why = "the command does not change" if value else "the actuator drives nothing"
        concern = "note"
    elif signal.channel.quantity == "position":
        why = "the body never moves, or the channel is stuck"
    else:
        why = "not connected, or stuck; leave the channel out if nothing acts"
    return [
        Finding(
            "stuck channels",
            concern,
            f"{signal.name} is {value:.4g} {signal.unit} throughout: {why}.",
            {"value": value},
            signal.record.file,
        )
    ]


def check_repeats(signal: Signal) -> list[Finding]:
    """Report samples of a position that the log repeats."""
    if signal.channel.quantity != "position":
        return []
    parts = [repeats(x, signal.rounded_to) + first for first, x in signal.stretches]
    odd = np.concatenate(parts)
    if not len(odd):
        return []
    changing = int(np.count_nonzero(np.diff(signal.values)))
    part = len(odd) / (changing + len(odd))
    row = int(odd[len(odd) // 2])
    return [
        Finding(
            "held samples",
            "warning" if part > 0.05 else "note",
            f"{signal.name}: {len(odd)} samples ({100 * part:.2g} % of those in motion) repeat the "
            "sample before although the body moves: the log is not in step with the sensor.",
            {"count": float(len(odd)), "part": part, "time": signal.time(row)},
            signal.record.file,
            signal.around(row, odd, name="repeats the one before", span=30),
        )
    ]


def check_update(signal: Signal) -> list[Finding]:
    """Report a channel that changes at a lower rate than the log."""
    is_force = signal.channel.quantity in ("actuator_force", "interaction_force")
    fewest = CHANGES_OF_FORCE if is_force else CHANGES
    every = update_period(*(x for _, x in signal.stretches), fewest=fewest)
    # a test by steps of two levels is no slow channel
    if every == 1 or is_force and len(np.unique(signal.values)) < LEVELS:
        return []
    period = every * signal.record.sample_time
    return [
        Finding(
            "held samples",
            "note",
            f"{signal.name} changes only every {every} samples: it runs at {1 / period:.4g} Hz, "
            f"the log at {1 / signal.record.sample_time:.4g} Hz.{_of_one_body(signal)}"
            f"{_of_a_force(signal)}",
            {"samples": float(every), "rate": 1 / period},
            signal.record.file,
        )
    ]


def _of_one_body(signal: Signal) -> str:
    """What to do where the other body of an experiment may be logged faster; "" for one body."""
    body, dot, _ = signal.name.rpartition(".")
    if not dot or signal.channel.quantity != "position":
        return ""
    return (
        f" The motion has steps between readings, which hide effects: diagnose the {body} in "
        "an experiment with its channels alone, of which one row of each reading is read."
    )


def _of_a_force(signal: Signal) -> str:
    """What a held reading means where it may be a command; "" for other quantities."""
    if signal.channel.quantity != "actuator_force":
        return ""
    return (
        " A command acts as it is held; of a measured force, what is faster than half of this rate "
        "is lost."
    )


def check_stuck(signal: Signal) -> list[Finding]:
    """Report stretches in which a channel holds its value while it should change."""
    holds = [
        (first + a, first + b)
        for first, x in signal.stretches
        for a, b in stuck_stretches(x, signal.rounded_to, signal.channel.quantity)
    ]
    if not holds:
        return []
    a, b = max(holds, key=lambda h: h[1] - h[0])
    h = signal.record.sample_time
    total = sum(q - p for p, q in holds) * h
    more = "" if len(holds) == 1 else f" ({len(holds)} times, {total:.3g} s in all)"
    return [
        Finding(
            "stuck channels",
            "warning",
            f"{signal.name} is stuck at {signal.values[a]:.4g} {signal.unit} from "
            f"{signal.time(a):.6g} to {signal.time(b - 1):.6g} s{more}: cut that out, with "
            "records of the same file and span = [begin, end] before and after it.",
            {
                "from": signal.time(a),
                "to": signal.time(b - 1),
                "duration": total,
                "count": float(len(holds)),
            },
            signal.record.file,
            signal.around(a, np.arange(a, b), name="stuck"),
        )
    ]

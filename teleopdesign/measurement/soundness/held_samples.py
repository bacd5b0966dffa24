"""Held samples: readings that repeat the one before where they should have changed.

Single ones come from a log that runs faster than what it records, long ones from a sensor that is
stuck, a channel that is constant throughout from a wire that is not connected.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...finding import Finding
from ..filtering import Array
from .signal import FALSE_ALARM, Signal

#: changes from sample to sample that count as motion, in steps between values
STEPS = 3.0
#: samples to either side over which a usual change is taken
NEAR = 10
#: chance of a zero among normal changes: density at zero times the step, over the median change
_ZERO = 0.3989 * 0.6745
#: changes on leaving a hold, in usual changes before it, that reveal it
LEAP = 5.0
#: samples that a hold must last to be called stuck: shorter ones are counted as repeats
LASTING = 10


def check_constant(signal: Signal) -> list[Finding]:
    """A channel that says the same all the time."""
    if np.ptp(signal.values) > 0:
        return []
    value = float(signal.values[0])
    concern: Literal["note", "warning"] = "warning"
    if signal.channel.quantity == "actuator_force":
        concern, why = "note", "the actuator drives nothing"
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


def runs_of(mask: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First place of each run of True, and one past its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return edges[::2], edges[1::2]


def repeats(x: Array, step: float) -> NDArray[np.intp]:
    """Samples of a position that repeat the one before although the body goes on.

    Into the hold and out of it the reading changes by half of the usual change there or more, the
    same way: no body stops and starts within a sample.
    """
    change = np.diff(x)
    first, past = runs_of(change == 0)
    inside = (first > 0) & (past < len(change)) & (past - first < LASTING)
    first, past = first[inside], past[inside]
    low, high = np.maximum(first - NEAR, 0), np.minimum(past + NEAR, len(x) - 1)
    usual = (x[high] - x[low]) / (high - low)
    way, size = np.sign(usual), np.abs(usual)
    into, out = way * change[first - 1], way * change[past]
    is_held = (size >= STEPS * step) & (into >= 0.5 * size) & (out >= 0.5 * size)
    pairs = zip(first[is_held].tolist(), past[is_held].tolist(), strict=True)
    rows = [np.arange(a, b) + 1 for a, b in pairs]
    return np.concatenate(rows) if rows else np.zeros(0, dtype=np.intp)


def check_repeats(signal: Signal) -> list[Finding]:
    """Samples of a position that the log repeats."""
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
            "one before while the body goes on: the log is not in step with the sensor.",
            {"count": float(len(odd)), "part": part, "time": signal.time(row)},
            signal.record.file,
            signal.around(row, odd, name="repeats the one before", span=30),
        )
    ]


def check_update(signal: Signal) -> list[Finding]:
    """A channel that changes at a lower rate than the log's."""
    apart = np.concatenate([np.diff(np.flatnonzero(np.diff(x))) for _, x in signal.stretches])
    if len(apart) < 50:
        return []
    every = int(np.median(apart))
    # changes lie a whole number of periods apart, all but a few
    if every < 2 or np.mean(apart % every == 0) < 0.9:
        return []
    period = every * signal.record.sample_time
    return [
        Finding(
            "held samples",
            "note",
            f"{signal.name} changes only every {every} samples: it runs at {1 / period:.4g} Hz, "
            f"the log at {1 / signal.record.sample_time:.4g} Hz.",
            {"samples": float(every), "rate": 1 / period},
            signal.record.file,
        )
    ]


def stuck_stretches(x: Array, step: float, quantity: str) -> list[tuple[int, int]]:
    """(first, one past the last) sample of holds that only a stuck channel explains.

    quantity: a position stops dead and leaps afterwards, or never moves again; noise of any other
    measured quantity cannot vanish; a command may be held at will
    """
    if quantity == "actuator_force":
        return []
    change = np.diff(x)
    first, past = runs_of(change == 0)
    lasting = (past - first >= LASTING) & (first >= 5)
    stretches = []
    for a, b in zip(first[lasting].tolist(), past[lasting].tolist(), strict=True):
        before = np.abs(change[a - 5 : a])
        usual = float(np.median(before))
        if usual < STEPS * step:
            continue
        ends = b == len(change)
        leaps = not ends and abs(change[b]) > LEAP * max(usual, step)
        # a reading that was stuck leaps once; a body that rested at a reversal goes on as it began
        leaps = leaps and (b + 1 >= len(change) or abs(change[b + 1]) < 0.5 * abs(change[b]))
        if quantity == "position":
            slowing = abs(change[a - 1] - change[a - 3]) / 2
            dead = abs(change[a - 1]) > max(STEPS * step, LEAP * slowing)
            is_stuck = dead and (leaps or ends)
        else:
            chance = (b - a) * np.log(_ZERO * step / usual)
            is_stuck = bool(chance < np.log(FALSE_ALARM / len(x)))
        if is_stuck:
            stretches.append((a, b + 1))
    return stretches


def check_stuck(signal: Signal) -> list[Finding]:
    """Stretches in which one channel holds its value while it should not."""
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

"""Clipped channels: a signal that stays at one value where it should continue.

A sine that is sampled often enough rests near its peak, too, and a body may rest at a stop. A
signal counts as clipped only where it arrives with speed, several times, and stops abruptly.
"""

from __future__ import annotations

import numpy as np

from ...base.finding import Finding
from ..encoder import reading_noise
from ..filtering import Array
from ..repeated_rows import STEPS, runs_of
from .signal import Signal

#: a value counts as a limit if the signal arrives there so often while it moves
VISITS = 3
#: fewest samples that the signal stays at the limit
LASTS = 3
#: deceleration before the arrival, relative to the speed, above which the body stopped by itself
SLOWING = 0.5


def visits(x: Array, limit: float, step: float, *, noisy: bool) -> tuple[int, int]:
    """How often the signal runs into `limit` with speed and stays, and samples spent there.

    noisy: readings scatter, so that equal successive readings are unlikely: every stay counts
    """
    first, past = runs_of(x == limit)
    lasting = (past - first >= LASTS) & (first >= 4)
    if noisy:
        return int(lasting.sum()), int((past - first)[lasting].sum())
    count = spent = 0
    for a, b in zip(first[lasting].tolist(), past[lasting].tolist(), strict=True):
        coming = np.diff(x[a - 4 : a])  # without the last change, which the limit cuts
        arrived = abs(float(coming[-1]))
        slowing = abs(float(coming[-1] - coming[0])) / 2
        towards = np.all(np.sign(coming) == np.sign(limit - x[a - 1]))
        if towards and arrived >= STEPS * step and slowing < SLOWING * arrived:
            count, spent = count + 1, spent + b - a
    return count, spent


def check_clipped(signal: Signal) -> list[Finding]:
    """Report the largest and smallest value of a channel if the signal runs flat against it."""
    findings = []
    noisy = reading_noise(signal.values) > STEPS * signal.rounded_to > 0
    for name, value in (("largest", signal.values.max()), ("smallest", signal.values.min())):
        count = spent = 0
        for _, x in signal.stretches:
            c, s = visits(x, float(value), signal.rounded_to, noisy=noisy)
            count, spent = count + c, spent + s
        if count < VISITS:
            continue
        at = np.flatnonzero(signal.values == value)
        part = len(at) / len(signal.values)
        commanded = signal.channel.quantity == "actuator_force"
        why = (
            "fine if the command itself is limited there, wrong if only the log is"
            if commanded
            else "the channel is clipped: cut these out, or record with a larger range"
        )
        findings.append(
            Finding(
                "clipped channels",
                "note" if commanded else "warning",
                f"{signal.name} runs flat against its {name} value {value:.4g} {signal.unit}, "
                f"{count} times, {100 * part:.2g} % of the samples: {why}.",
                {"value": float(value), "count": float(count), "part": part},
                signal.record.file,
                signal.around(int(at[0]), at, name=f"at the {name} value"),
            )
        )
    return findings

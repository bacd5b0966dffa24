"""Force steps: a force with a coarse resolution in the log, or one that mostly reads zero."""

from __future__ import annotations

import numpy as np

from ...base.finding import Finding
from .encoder_steps import ON_GRID, measure_griddedness
from .signal import Signal

#: rounding error over the standard deviation of the signal, from which a step is reported. A step
#: of a hundredth of the largest value has 0.007 and changed no diagnosis; a tenth has 0.07 and
#: leaves an error of six noise floors
COARSE = 0.03
#: fewest levels of a rounded signal: a relay has two or three, on purpose
LEVELS = 5
#: part of all changes that lead to the next level: a rounded signal passes through every level
TO_THE_NEXT = 0.9
#: rows, and fewest times, that a force differs from zero at a time, where its log lacks readings: a
#: test with pulses holds each one for longer, or has fewer
SHORT, OFTEN = 4.0, 20


def check_lost_force(signal: Signal) -> list[Finding]:
    """Report a force that mostly reads zero, and other values for a few rows at a time."""
    if signal.channel.quantity not in ("actuator_force", "interaction_force"):
        return []
    acts = signal.values != 0.0
    times = int(np.count_nonzero(np.diff(acts.astype(int)) == 1))
    part, rows = float(np.mean(acts)), float(np.count_nonzero(acts)) / max(times, 1)
    if part > 0.5 or times < OFTEN or rows > SHORT:
        return []
    return [
        Finding(
            "force steps",
            "warning",
            f"{signal.name} is exactly 0 in {100 * (1 - part):.0f} % of the rows, and differs from "
            f"0 for {rows:.1f} rows at a time: the log lacks readings, or the force hardly exceeds "
            "its resolution. No model of the device explains such a force.",
            {"part": 1 - part, "rows": rows, "count": float(times)},
            signal.record.file,
        )
    ]


def check_force_steps(signal: Signal) -> list[Finding]:
    """Report a force with steps so coarse that rounding hides its course between two steps."""
    if signal.channel.quantity not in ("actuator_force", "interaction_force") or not signal.step:
        return []
    step, spread = signal.step, float(np.std(signal.values))
    error = step / np.sqrt(12.0)  # of a value anywhere within its step
    if error < COARSE * spread or measure_griddedness(signal.values, step) < ON_GRID:
        return []
    levels = np.round((signal.values - signal.values[0]) / step)
    changes = np.abs(np.diff(levels))
    changes = changes[changes > 0]
    if len(np.unique(levels)) < LEVELS or np.mean(changes == 1) < TO_THE_NEXT:
        return []
    return [
        Finding(
            "force steps",
            "warning",
            f"{signal.name} moves in steps of {step:.4g} {signal.unit}: if the log alone is "
            f"rounded, {100 * error / spread:.1f} % of what it does is lost; log finer steps.",
            {"step": step, "error": float(error)},
            signal.record.file,
        )
    ]

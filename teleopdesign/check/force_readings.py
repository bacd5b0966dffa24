"""Readings of a force: coarse steps in the log, and hum of the mains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..base.finding import Finding
from ..base.sentences import percent
from ..measurement.encoder import is_on_grid
from ..measurement.limits import NEARLY_ALL
from ..measurement.spikes import STRONG, hum_of
from ._recording import CheckedRecording, RecordingCheck, Signal

#: rounding error over the standard deviation of the signal, from which a step is reported. A step
#: of a hundredth of the largest value has 0.007 and changed no diagnosis; a tenth has 0.07 and
#: leaves an error of six noise floors
COARSE = 0.03
#: fewest levels of a rounded signal: a relay has two or three, on purpose
LEVELS = 5


def find_poor_forces(recording: CheckedRecording) -> Iterator[Finding]:
    """Forces whose log has coarse steps, or hums."""
    for signal in recording.varying:
        if signal.is_force:
            yield from check_force_steps(signal)
            yield from check_hum(signal, recording.beside(signal))


CHECK = RecordingCheck(order=60, find=find_poor_forces)


def check_force_steps(signal: Signal) -> Iterator[Finding]:
    """Report a force with steps so coarse that rounding hides its course between two steps."""
    step, spread = signal.step, float(np.std(signal.values))
    error = step / np.sqrt(12.0)  # of a value anywhere within its step
    if not step or error < COARSE * spread or not is_on_grid(signal.values, step):
        return
    levels = np.round((signal.values - signal.values[0]) / step)
    changes = np.abs(np.diff(levels))
    if len(np.unique(levels)) < LEVELS or np.mean(changes[changes > 0] == 1) < NEARLY_ALL:
        return
    words = (
        f" moves in steps of {step:.4g} {signal.unit}: if the log alone is rounded, "
        f"{100 * error / spread:.1f} % of what it does is lost; log finer steps."
    )
    yield signal.finding("force steps", "warning", words, {"step": step, "error": float(error)})


def check_hum(signal: Signal, others: Sequence[Signal]) -> Iterator[Finding]:
    """Report a force with a tone of the mains, in a record whose positions have none.

    others: channels of the same record
    """
    rows = signal.record.longest
    still = [o.values[rows] for o in others if o.quantity == "position"]
    hum = hum_of(signal.values[rows], still, signal.record.sample_time)
    if hum is None:
        return
    share = hum.rms / float(signal.values[rows].std())
    words = (
        f" has a tone of {hum.mains:g} Hz, {hum.rms:.3g} {signal.unit} rms "
        f"({percent(share, '.2g')} of the channel), that no position shows: hum of the mains? A "
        "diagnosis takes it off; shield the wire, or compare below that frequency."
    )
    numbers = {"frequency": hum.mains, "rms": hum.rms}
    yield signal.finding("hum", "warning" if share >= STRONG else "note", words, numbers)

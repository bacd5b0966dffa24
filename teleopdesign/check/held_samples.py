"""Held samples: readings that repeat the reading before although the body moves.

Single repeats come from a log that is not in step with its source. A channel that changes every few
rows comes from a slower source.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Finding
from ..base.sentences import percent
from ..measurement.encoder import CHANGES, CHANGES_OF_FORCE, update_period
from ..measurement.limits import SMALL
from ..measurement.repeated_rows import repeats
from ._recording import CheckedRecording, RecordingCheck, Signal
from .force_readings import LEVELS


def find_held_samples(recording: CheckedRecording) -> Iterator[Finding]:
    """Samples of a position that the log repeats, and channels of a slower source."""
    for signal in recording.varying:
        if signal.quantity == "position":
            yield from check_repeats(signal)
        yield from check_update(signal)


CHECK = RecordingCheck(order=40, find=find_held_samples)


def check_repeats(signal: Signal) -> Iterator[Finding]:
    """Report samples of a position that the log repeats."""
    parts = [repeats(x, signal.rounded_to) + first for first, x in signal.stretches]
    odd = np.concatenate(parts)
    if not len(odd):
        return
    part = len(odd) / (int(np.count_nonzero(np.diff(signal.values))) + len(odd))
    row = int(odd[len(odd) // 2])
    yield signal.finding(
        "held samples",
        "warning" if part > SMALL else "note",
        f": {len(odd)} samples ({percent(part, '.2g')} of those in motion) repeat the sample "
        "before although the body moves: the log is not in step with the sensor.",
        {"count": float(len(odd)), "part": part, "time": signal.time(row)},
        signal.around(row, odd, name="repeats the one before", span=30),
    )


def check_update(signal: Signal) -> Iterator[Finding]:
    """Report a channel that changes at a lower rate than the log."""
    fewest = CHANGES_OF_FORCE if signal.is_force else CHANGES
    every = update_period(*(x for _, x in signal.stretches), fewest=fewest)
    # a test by steps of two levels is no slow channel
    if every == 1 or signal.is_force and len(np.unique(signal.values)) < LEVELS:
        return
    rate = 1 / (every * signal.record.sample_time)
    more = ""
    body, dot, _ = signal.name.rpartition(".")
    if dot and signal.quantity == "position":
        more = (
            f" The motion has steps between readings, which hide effects: diagnose the {body} in "
            "an experiment with its channels alone, of which one row of each reading is read."
        )
    elif signal.quantity == "actuator_force":
        more = (
            " A command acts as it is held; of a measured force, what is faster than half of this "
            "rate is lost."
        )
    words = (
        f" changes only every {every} samples: it runs at {rate:.4g} Hz, the log at "
        f"{1 / signal.record.sample_time:.4g} Hz.{more}"
    )
    yield signal.finding("held samples", "note", words, {"samples": float(every), "rate": rate})

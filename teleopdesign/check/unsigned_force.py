"""Records of the size of a force that takes both signs: no model of the device balances it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Finding
from ..measurement.first_guess import is_size
from ..measurement.record import Record
from ._recording import CheckedRecording, RecordingCheck


def find_unsigned_force(recording: CheckedRecording) -> Iterator[Finding]:
    """Whether the only force never changes its sign, but rises with the speed both ways."""
    body, records = recording.lone_body, recording.experiment.fit_records
    if body is None or any(f"{body}.interaction_force" in r.signals for r in records):
        return
    for sign in (1.0, -1.0):
        signed = all(np.min(sign * r.signals[f"{body}.actuator_force"]) >= 0.0 for r in records)
        if signed and any(_holds_size(record, body, sign) for record in records):
            sentence = (
                "The force never changes its sign, but is larger in motion both ways: it is the "
                "size of a force, such as the supply current of a servo, and these records tell no "
                "effect. Log it with its sign."
            )
            yield Finding("unsigned force", "warning", sentence, stops=True)


CHECK = RecordingCheck(order=230, find=find_unsigned_force, may_stop=True)


def _holds_size(record: Record, body: str, sign: float) -> bool:
    """Whether the longest stretch of a record holds the size of a force, turned by a sign."""
    rows = record.longest
    force = sign * record.signals[f"{body}.actuator_force"][rows]
    return is_size(force, record.signals[f"{body}.position"][rows], record.sample_time)

"""Records of the size of a force that takes both signs: no model of the device balances it."""

from __future__ import annotations

import numpy as np

from ..measurement.experiment import Experiment
from ..measurement.first_guess import is_size
from ..measurement.record import Record


def describe_unsigned(experiment: Experiment) -> str | None:
    """A sentence where the only force is never negative, but rises with the speed both ways.

    Only for one body without a second force: their sum is what moves it.
    """
    if len(experiment.bodies) != 1 or experiment.arm is not None:
        return None
    (body,) = experiment.bodies
    records = experiment.fit_records
    if any(f"{body}.interaction_force" in r.signals for r in records):
        return None
    forces = [r.signals.get(f"{body}.actuator_force") for r in records]
    for sign in (1.0, -1.0):
        if any(f is None or np.min(sign * f) < 0.0 for f in forces):
            continue
        if any(_holds_size(record, body, sign) for record in records):
            return (
                "The force never changes its sign, but is larger in motion both ways: it is the "
                "size of a force, such as the supply current of a servo. Log it with its sign; "
                "these records tell no effect."
            )
    return None


def _holds_size(record: Record, body: str, sign: float) -> bool:
    """Whether the longest stretch of a record holds the size of a force, turned by a sign."""
    rows = max(record.segments, key=lambda s: s.stop - s.start)
    force = sign * record.signals[f"{body}.actuator_force"][rows]
    return is_size(force, record.signals[f"{body}.position"][rows], record.sample_time)

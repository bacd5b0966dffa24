"""Columns of position and force of one body that are exchanged.

This shows without a model: inertia and friction explain a force by the motion, but not a position
by a force.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..base.finding import Finding
from ..base.sentences import percent
from ..measurement.first_guess import explain_force
from ._recording import CheckedRecording, RecordingCheck

#: columns seem exchanged if the motion explains less than AS_LOGGED of the force as logged, and
#: more than EXCHANGED of it the other way round. On the recordings of `fetch` and twelve simulated
#: ones the part is 0.47 to 1.0 for columns in their places, and, with one exception (0.43), at most
#: 0.2 for exchanged columns
AS_LOGGED, EXCHANGED = 0.25, 0.6


def find_mixed_columns(recording: CheckedRecording) -> Iterator[Finding]:
    """Bodies whose force is explained by the motion only if it is taken for the position."""
    if recording.prepared is None:
        return
    experiment = recording.prepared.experiment
    record = experiment.fit_records[0]
    rows = record.longest
    for body in experiment.bodies:
        keys = [f"{body}.{q}" for q in ("position", "actuator_force")]
        position, force = (record.signals[key][rows] for key in keys)
        hand = record.signals.get(f"{body}.interaction_force")
        other = 0.0 if hand is None else hand[rows]
        if force.std() == 0.0 or position.std() == 0.0:
            continue
        as_logged = explain_force(force + other, position, record.sample_time).explained
        exchanged = explain_force(position + other, force, record.sample_time).explained
        if as_logged < AS_LOGGED and exchanged > EXCHANGED:
            names = [recording.label(key) for key in keys]
            columns = [experiment.channels[key].column for key in keys]
            sentence = (
                f"the columns of {names[0]} and {names[1]} seem swapped: motion explains "
                f"{percent(max(as_logged, 0.0), '.2g')} of the force, {percent(exchanged, '.2g')} "
                f'the other way round; write column = "{columns[1]}" at channels.{names[0]} and '
                f'column = "{columns[0]}" at channels.{names[1]}.'
            )
            numbers = {"as_given": as_logged, "swapped": exchanged}
            yield Finding("swapped columns", "warning", sentence, numbers, body)


CHECK = RecordingCheck(order=110, find=find_mixed_columns)

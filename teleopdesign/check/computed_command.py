"""Commands that a controller computes from the motion alone: their law is none of the device.

Example: the virtual spring of a haptic device that a hand moves, in a log without the force of the
hand. A spring explains such a command to the last digit, with an inertia of nearly 0, whatever the
device is: the controller reads the same position. So does a bias, or another force of the position.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

from ..base.finding import Finding
from ..base.units import unit_of
from ..measurement.experiment import Experiment
from ..measurement.law_of_readings import LawOfReadings, is_copy, law_of_readings, spring_of_copy
from ..measurement.record import Record
from ._recording import CheckedRecording, RecordingCheck


def find_computed_commands(recording: CheckedRecording) -> Iterator[Finding]:
    """Commands that are a law of the motion, to the last digit, where no hand's force is logged."""
    for body in recording.experiment.bodies:
        computed = describe_computed(recording.experiment, body)
        hidden = "no spring, no constant force and no other force of the position can be told"
        if computed is None and _is_of_velocity(recording.experiment, body):
            computed = "the velocity times a constant plus a constant, to the last digit"
            hidden = "the damping is that of the controller"
        if computed is not None:
            sentence = (
                f"{recording.label(f'{body}.actuator_force')} is {computed}. A controller computes "
                f"it, and {hidden}. Where a hand moves the device, the records tell nothing of the "
                "device: log the force of the hand, or a motion under a command of its own."
            )
            yield Finding("feedback", "warning", sentence)


CHECK = RecordingCheck(order=100, find=find_computed_commands)


def describe_computed(experiment: Experiment, body: str) -> str | None:
    """What a controller computes the command from, after "the command is"; None: nothing.

    With a measured force of the hand, the sum of both forces is no law of the motion.
    """
    if f"{body}.interaction_force" in experiment.channels:
        return None
    if experiment.is_curve:
        return ""  # points of a friction curve have no position
    laws = [_law_of_record(record, body) for record in experiment.fit_records]
    law = laws[0] if all(laws) else None
    if law is None:
        return None
    axis = experiment.axis(body)
    spring = f"a virtual spring of {law.stiffness:.3g} {unit_of('stiffness', axis)}"
    damper = f" and damper of {law.damping:.3g} {unit_of('damping', axis)}"
    turned = " (negative: it pushes away, unless a sign is wrong)" if law.stiffness < 0.0 else ""
    where = ", where it is neither at rest nor at a limit" if law.is_partial else ""
    return (
        f"computed from the readings of the position, to the last digit: {spring}"
        f"{damper if law.is_damped else ''}{turned}{where}"
    )


@lru_cache(maxsize=16)  # asked for every effect that is compared
def _law_of_record(record: Record, body: str) -> LawOfReadings | None:
    command, position = (record.signals[f"{body}.{q}"] for q in ("actuator_force", "position"))
    return spring_of_copy(command, position) or law_of_readings(
        command,
        position,
        record.segments,
        sample_time=record.sample_time,
        velocity=record.signals.get(f"{body}.velocity"),
    )


def _is_of_velocity(experiment: Experiment, body: str) -> bool:
    """Whether the command of every fit record is a velocity that is measured, but for constants."""
    velocity, command, hand = (
        f"{body}.{q}" for q in ("velocity", "actuator_force", "interaction_force")
    )
    if hand in experiment.channels or velocity not in experiment.channels:
        return False
    return all(is_copy(r.signals[command], r.signals[velocity]) for r in experiment.fit_records)

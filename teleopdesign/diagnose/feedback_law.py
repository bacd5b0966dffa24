"""Commands that a controller computes from the position: their law is none of the device.

Example: the virtual spring of a haptic device that a hand moves, in a log without the force of the
hand. A spring explains such a command to the last digit, with an inertia of nearly 0, whatever the
device is: the controller reads the same position. So does a bias, or another force of the position.
"""

from __future__ import annotations

from functools import lru_cache

from ..base.units import unit_of
from ..effects import SIGNALS, Effect
from ..measurement.experiment import Experiment
from ..measurement.law_of_readings import LawOfReadings, law_of_readings
from ..measurement.record import Record
from ..measurement.survey.copies import is_copy


@lru_cache(maxsize=256)
def is_of_place(effect: Effect) -> bool:
    """Whether an effect is a force that depends on the position at most."""
    signals = effect.expression().free_symbols & set(SIGNALS.values())
    return effect.role == "force" and not effect.states and signals <= {SIGNALS["position"]}


def is_computed(experiment: Experiment, body: str, *, of: str = "position") -> bool:
    """Whether the command of every fit record is a reading times a constant plus a constant.

    of: quantity of the reading, "position" or "velocity"
    Up to rounding, and without a measured force of the hand: with it, the sum of both forces is no
    law of the motion. A force that is measured has noise of its own.
    """
    reading, command, hand = (f"{body}.{q}" for q in (of, "actuator_force", "interaction_force"))
    if hand in experiment.channels:
        return False
    signals = [r.signals for r in experiment.fit_records if {reading, command} <= set(r.signals)]
    return bool(signals) and all(is_copy(s[command], s[reading]) for s in signals)


def computed_law(experiment: Experiment, body: str) -> LawOfReadings | None:
    """The law of a controller that computes the command of every fit record from its readings.

    None: there is no such law, or a force of the hand is measured
    """
    needed = {f"{body}.position", f"{body}.actuator_force"}
    if f"{body}.interaction_force" in experiment.channels:
        return None
    laws = [_law_of_record(r, body) for r in experiment.fit_records if needed <= set(r.signals)]
    return laws[0] if laws and all(laws) else None


@lru_cache(maxsize=16)  # asked for every effect that is compared
def _law_of_record(record: Record, body: str) -> LawOfReadings | None:
    return law_of_readings(
        record.signals[f"{body}.actuator_force"],
        record.signals[f"{body}.position"],
        record.segments,
        sample_time=record.sample_time,
        velocity=record.signals.get(f"{body}.velocity"),
    )


def describe_computed(experiment: Experiment, body: str) -> str | None:
    """What a controller computes the command from, after "the command is"; None: nothing."""
    if is_computed(experiment, body):
        return "the position times a constant plus a constant, to the last digit"
    law = computed_law(experiment, body)
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


def explain_computed(effect: Effect, experiment: Experiment, body: str) -> str | None:
    """A sentence where an effect only repeats the law of a controller; else None."""
    if not is_of_place(effect):
        return None
    computed = describe_computed(experiment, body)
    if computed is None:
        return None
    return f"the command is {computed}; a controller computes it, and the effect repeats this law"

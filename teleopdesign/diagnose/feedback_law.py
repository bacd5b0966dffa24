"""Commands that a controller computes from the position: their law is none of the device.

Example: the virtual spring of a haptic device that a hand moves, in a log without the force of the
hand. A spring explains such a command to the last digit, with an inertia of nearly 0, whatever the
device is: the controller reads the same position. So does a bias, or another force of the position.
"""

from __future__ import annotations

from ..effects import SIGNALS, Effect
from ..measurement.experiment import Experiment
from ..measurement.survey.copies import is_copy


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


def explain_computed(effect: Effect, experiment: Experiment, body: str) -> str | None:
    """A sentence where an effect only repeats the law of a controller; else None."""
    if not (is_of_place(effect) and is_computed(experiment, body)):
        return None
    return (
        "the command is the position times a constant plus a constant, to the last digit: a "
        "controller computes it, and the effect repeats this law"
    )

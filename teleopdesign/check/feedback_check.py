"""Commands that a controller computes from the motion alone: virtual springs and dampers."""

from __future__ import annotations

from collections.abc import Iterator

from ..diagnose.feedback_law import is_computed
from ..finding import Finding
from ..measurement.experiment import Experiment
from ..measurement.soundness.signal import channel_label

#: quantity of the reading -> what cannot be told beside a command that repeats it
_HIDDEN = {
    "position": "no spring, no constant force and no other force of the position can be told",
    "velocity": "the damping is that of the controller",
}


def check_feedback(experiment: Experiment) -> Iterator[Finding]:
    """A warning for each command that is a law of the motion, to the last digit."""
    for body in experiment.bodies:
        for quantity, hidden in _HIDDEN.items():
            if is_computed(experiment, body, of=quantity):
                command = channel_label(experiment, f"{body}.actuator_force")
                yield Finding(
                    "feedback",
                    "warning",
                    f"{command} is the {quantity} times a constant plus a constant, to the last "
                    f"digit: a controller computes it, and {hidden}. Where a hand moves the "
                    "device, the records tell nothing of the device: log the force of the hand, "
                    "or a motion under a command of its own.",
                )

"""Commands that a controller computes from the motion alone: virtual springs and dampers."""

from __future__ import annotations

from collections.abc import Iterator

from ..base.finding import Finding
from ..diagnose.feedback_law import describe_computed, is_computed
from ..measurement.experiment import Experiment
from ..measurement.soundness.signal import channel_label


def check_feedback(experiment: Experiment) -> Iterator[Finding]:
    """A warning for each command that is a law of the motion, to the last digit."""
    for body in experiment.bodies:
        computed = describe_computed(experiment, body)
        hidden = "no spring, no constant force and no other force of the position can be told"
        if computed is None and is_computed(experiment, body, of="velocity"):
            computed = "the velocity times a constant plus a constant, to the last digit"
            hidden = "the damping is that of the controller"
        if computed is None:
            continue
        yield Finding(
            "feedback",
            "warning",
            f"{channel_label(experiment, f'{body}.actuator_force')} is {computed}. A controller "
            f"computes it, and {hidden}. Where a hand moves the device, the records tell nothing "
            "of the device: log the force of the hand, or a motion under a command of its own.",
        )

"""Records in which something that is not measured drives the device: they tell no effect."""

from __future__ import annotations

from ..measurement.experiment import Experiment
from ..measurement.logger_clock import CLOCK
from ..measurement.work_balance import work_out_of_record


def work_taken_out(experiment: Experiment) -> float | None:
    """Work (J) that the measured forces take out of each fit record, at least; None: not surely.

    Only for one body: another body that is coupled to it, or the links of an arm, do work as well.
    """
    if len(experiment.bodies) != 1 or experiment.arm is not None:
        return None
    (body,) = experiment.bodies
    work = min(
        work_out_of_record(record, body, latest=CLOCK.latest) for record in experiment.fit_records
    )
    return work if work > 0.0 else None


def describe_work(experiment: Experiment) -> str | None:
    """A sentence where the measured forces take energy out of the motion; else None."""
    work = work_taken_out(experiment)
    if work is None:
        return None
    return (
        f"The measured forces take {work:.2g} J or more out of the motion of each fit record, as "
        "friction does: a hand (or another drive) that is not logged moves the device, or the sign "
        "of the force or of the position is wrong. These records tell no effect."
    )

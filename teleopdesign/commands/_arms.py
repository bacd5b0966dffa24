"""One joint of an arm, for commands that work on one body: its name, its records, its inertia."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError, unknown
from ._options import add_repeated, split_pairs, value_from

if TYPE_CHECKING:
    from ..diagnose import Diagnosis
    from ..measurement import Experiment
    from ..model import Model


def add_body(parser: argparse.ArgumentParser, *, pose: bool = False) -> None:
    """Arguments: the body; with `pose`, the pose of an arm for the inertia of the joint."""
    parser.add_argument(
        "--body",
        metavar="NAME",
        help="one body of a teleoperator, or one joint of an arm (required for an arm)",
    )
    if pose:
        add_repeated(
            parser,
            "--pose",
            "JOINT=VALUE[UNIT]",
            "for an arm: position of a joint in the pose for which the inertia of the chosen joint "
            "is computed; a joint without a position is at 0; without --pose, the inertia is the "
            "mean over the recorded poses",
        )


def chosen_body(bodies: Iterable[str], options: argparse.Namespace, where: object) -> str:
    """The body, or the joint of an arm, that the options name; by default the only one.

    raises ExperimentError: no such body, or several ones and none is chosen; it lists all of them
    """
    known, chosen = list(bodies), options.body
    if chosen is None and len(known) > 1:
        raise ExperimentError(f"{where}: {', '.join(known)}: choose one with --body")
    if chosen is not None and chosen not in known:
        raise ExperimentError(f"--body: {unknown('body', chosen, known)}")
    return chosen or known[0]


def place_at_pose(diagnosis: Diagnosis, joint: str, options: argparse.Namespace) -> Model:
    """The model of one joint, with the inertia of the links about the joint at the stated pose.

    diagnosis: of the whole arm
    raises ExperimentError: no such joint or unit, or the computed inertia there is not positive
    """
    import numpy as np

    from ..diagnose.other_motion import follows_another
    from ..diagnose.parts import inertias_at, motor_inertias
    from ..model import Model

    name, model = f"{joint}.inertia", diagnosis.model
    body = model.bodies[joint]
    for effect in body.effects:
        if follows_another(effect):  # the others rest
            body = body.without_effect(effect.name)
    alone = Model({joint: body}, model.known, model.record_shift)
    if not options.pose:
        return alone
    experiment = diagnosis.experiment
    pose = _read_pose(options.pose, experiment)
    position = np.array([[pose.get(j, 0.0)] for j in experiment.bodies])
    inertias = inertias_at(experiment, model.links, position)
    size = float(inertias[list(experiment.bodies).index(joint), 0])
    size += motor_inertias(experiment, model)[joint]
    if not size > 0:
        raise ExperimentError(
            f"--pose: {joint} would have an inertia of {size:.3g}: base parameters describe "
            "motions like those recorded, and this pose is far from them"
        )
    return alone.with_values({name: size})


def _read_pose(texts: list[str], experiment: Experiment) -> dict[str, float]:
    """Joint -> position (SI), from texts JOINT=VALUE[UNIT]."""
    pose, joints = {}, list(experiment.bodies)
    for joint, value in split_pairs(texts, "--pose", "JOINT=VALUE").items():
        where = f"--pose {joint}={value}"
        if joint not in joints:
            raise ExperimentError(f"{where}: {unknown('joint', joint, joints)}")
        axis = experiment.axis(joint)
        pose[joint] = value_from(value, quantity="position", axis=axis, where=where)
    return pose


def inertia_line(model: Model, joint: str, options: argparse.Namespace) -> str:
    """A sentence on the assumptions when a joint is treated as one body without its arm."""
    value, unit = model.parameters[f"{joint}.inertia"].value, model.unit(f"{joint}.inertia")
    where = "at the stated pose" if options.pose else "the mean over the recorded poses"
    return (
        f"{joint} of an arm, the other joints at rest: inertia {value:.4g} {unit}, {where}; "
        "gravity and the motion of the others are for the arm's own controller"
    )

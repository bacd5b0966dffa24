"""A force between two bodies, at half of the step that the command puts into it.

    step of R_M = m_H / (m_M + m_H) step of R_A        while the device moves

The computer reads a force just before its command steps, and the acceleration steps with the
command. The motion at the rows tells the mean of both sides of the step. So the reading and the
force that the motion asks for differ by half a step: on drawn interfaces up to 0.5 % of the force,
twice the noise of its sensor. The inertias are those of the diagram: a tenth off, they leave a
tenth of the half step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..diagrams import Attached, Moving
from ..measurement.filtering import Array
from .computer import ComputerPart, Passes, Placed, whole_passes_of
from .cuts import Cut
from .diagram_experiment import DiagramExperiment, RecordedLog


def share_of_step(experiment: DiagramExperiment, signal: str) -> tuple[Moving, float] | None:
    """The body whose command steps in a force, and the share of the step; None: the force is even.

    A sensor that the computer does not read has its own moments, so that nothing is known of it.
    """
    diagram = experiment.diagram
    if signal not in experiment.read_by_computer:
        return None
    junction = next((j for j in diagram.junctions if j.output == signal), None)
    terms = {signal: 1.0} if junction is None else junction.terms
    for held in (b for b in diagram.blocks if isinstance(b, Attached) and b.force in terms):
        moving = [b for b in diagram.moving if b.motion == held.motion]
        whole = sum(_inertia(b) for b in diagram.blocks if b in moving or _is_at(b, held.motion))
        if len(moving) == 1 and whole > 0.0 and _inertia(held) > 0.0:
            if not _has_command(experiment, moving[0]):
                return None
            return moving[0], float(terms[held.force]) * held.sign * _inertia(held) / whole
    return None


def force_at_half_step(
    experiment: DiagramExperiment, signal: str, log: RecordedLog, placed: Sequence[Placed] = ()
) -> Array:
    """A force as recorded, with half of the command's step added where the body moves, SI, (n,).

    placed: effects in the laws of a command that is not recorded
    """
    recorded = experiment.signal(signal, log)
    share = share_of_step(experiment, signal)
    if share is None:
        return recorded
    moving, part = share
    step = np.diff(command_of(experiment, moving, log, placed), prepend=np.nan)
    position = experiment.signal(moving.motion, log)
    moves = np.zeros(len(position), dtype=bool)
    moves[1:-1] = position[2:] != position[:-2]
    return recorded + 0.5 * part * np.nan_to_num(step) * moves


def command_of(
    experiment: DiagramExperiment, moving: Moving, log: RecordedLog, placed: Sequence[Placed] = ()
) -> Array:
    """The command of a body, held between rows: recorded, or as the computer's laws give it.

    placed: effects in the laws of a command that is not recorded
    raises ModelError: it is not recorded, and no rows or laws to predict it
    """
    if moving.command in experiment.channels:
        return experiment.signal(moving.command, log)
    part = laws_of_command(experiment, moving)
    return command_by_laws(part, whole_passes_of(experiment, log), log.count, placed)


def command_by_laws(
    part: ComputerPart, rows: Passes, count: int, placed: Sequence[Placed] = ()
) -> Array:
    """The command that laws give, held between the passes of the computer, at `count` rows."""
    made = part.signal(part.cuts[0], rows, placed)
    return np.repeat(made, -(-count // len(made)))[:count]


def laws_of_command(experiment: DiagramExperiment, moving: Moving) -> ComputerPart:
    """The laws that make the command of a body, which is not recorded, as a cut of its own."""
    made = next(c for c in experiment.cuts.tested if c.name == moving.name)
    cut = Cut(moving.command, moving.command, "computer", made.blocks, made.inputs)
    return ComputerPart(experiment.diagram, (cut,), experiment.zero, experiment.computer)


def _has_command(experiment: DiagramExperiment, moving: Moving) -> bool:
    """Whether the command of a body and its motion are recorded, or a cut predicts the command."""
    cuts = [cut.name for cut in experiment.cuts.tested]
    recorded = experiment.channels
    return moving.motion in recorded and (moving.command in recorded or moving.name in cuts)


def _is_at(block: object, motion: str) -> bool:
    return isinstance(block, Attached) and block.motion == motion


def _inertia(block: object) -> float:
    values = getattr(getattr(block, "body", None), "parameters", {})
    return float(values["inertia"].value) if "inertia" in values else 0.0

"""The answer of a whole diagram as a file: written, and read without any search.

Diagnoses of bodies are saved as such. Of the computer the values of each fit are saved; their
errors are computed again along the records.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ..base.arguments import check_types
from ..base.errors import ExperimentError
from ..base.files import write_json
from ..diagnose import Diagnosis
from ..diagnose.answer import content_of_answer, diagnosis_in, folder_of_answer
from ..diagrams import Diagram
from ..effects import EFFECTS, Effect
from ..effects.of_blocks.controllers import CONTROL_EFFECTS
from ..measurement.experiment import Experiment
from .body import body_experiment
from .computer import Placed, free_parameters
from .computer_fit import ControlData, data_of_computer
from .computer_search import Attempt, ComputerLadder, ComputerStep
from .control_rows import ControlFit
from .cuts import Cuts
from .cuts_ladder import Key
from .diagnosis import BlockDiagnosis
from .diagram_experiment import DiagramExperiment
from .joined_cut import placed_for
from .reading import load_experiment


def write_answer(diagnosis: BlockDiagnosis, path: str | Path) -> None:
    """Write the answer as JSON, with the path of its experiment relative to the answer."""
    content, folder = diagnosis.answer(), diagnosis.experiment.folder
    content["experiment"] = {"title": diagnosis.experiment.title}
    if folder.is_dir():  # an experiment of arrays has none
        place = os.path.relpath(folder.resolve(), Path(path).resolve().parent)
        content["experiment"]["folder"] = Path(place).as_posix()
    if diagnosis.computer is not None:
        content["computer"] = _ladder_data(diagnosis.computer)
    if diagnosis.joined:
        content["joined"] = {n: _ladder_data(ladder) for n, ladder in diagnosis.joined.items()}
    write_json(path, content)


@check_types
def load_answer(
    path: str | Path,
    known: Mapping[str, Effect] | None = None,
    *,
    experiment: Experiment | DiagramExperiment | None = None,
) -> Diagnosis | BlockDiagnosis:
    """The diagnosis in an answer that `teleopdesign diagnose --json` or `write_answer` wrote.

    Nothing is searched or estimated again.
    known: effects of bodies by name, with those of the user; None: EFFECTS
    experiment: of this answer; None: it is read from the folder that the answer names
    raises ExperimentError: the file cannot be read, is no answer or one to another experiment, or
        an effect is unknown

        >>> diagnosis = td.load_answer("demo/answer.json")  # doctest: +SKIP
        >>> diagnosis.missing  # doctest: +SKIP
    """
    known, content = EFFECTS if known is None else known, content_of_answer(path)
    if not isinstance(content.get("tested"), dict):
        if isinstance(experiment, DiagramExperiment):
            raise ExperimentError(f"{path}: is an answer for bodies, not for a whole diagram")
        return diagnosis_in(content, path, known, experiment=experiment)
    stated = experiment or load_experiment(folder_of_answer(path))
    if not isinstance(stated, DiagramExperiment):
        raise ExperimentError(f"{path}: is an answer for a whole diagram, not for bodies")
    try:
        return _block_diagnosis(content, path, known, stated)
    except (KeyError, TypeError, ValueError) as error:
        raise ExperimentError(f"{path}: {error!r}: is no complete answer for a diagram") from error


def is_block_answer(path: Path) -> bool:
    """Whether a file is the answer of a whole diagram."""
    return isinstance(content_of_answer(path).get("tested"), dict)


def _block_diagnosis(
    content: Mapping[str, Any],
    path: str | Path,
    known: Mapping[str, Effect],
    experiment: DiagramExperiment,
) -> BlockDiagnosis:
    whole = experiment.cuts
    tested = tuple(c for c in whole.tested if c.name in content["tested"])
    cuts = Cuts(tested, dict(content["untested"]))
    bodies = {}
    joined = {
        n: _ladder_from(one, partial(_saved_fit, experiment))
        for n, one in content.get("joined", {}).items()
    }
    for name, one in content["bodies"].items():
        (cut,) = (c for c in tested if c.name == name)
        body = body_experiment(experiment, cut, placed_for(cut, joined))
        bodies[name] = replace(diagnosis_in(one, path, known, experiment=body), left_out=())
    data, ladder = None, None
    if "computer" in content:
        data = data_of_computer(experiment, cuts, bodies)
        ladder = _ladder_from(content["computer"], partial(_computed_fit, data))
    return BlockDiagnosis(experiment, cuts, bodies, ladder, data, joined)


def _ladder_data(ladder: ComputerLadder) -> dict[str, Any]:
    return {
        "base": _fit_data(ladder.base),
        "steps": [
            {
                "attempts": [
                    {
                        "fit": _fit_data(one.fit),
                        "score": one.score,
                        "behind": one.behind,
                        "refused": one.refused,
                        "probability": one.probability,
                    }
                    for one in step.attempts
                ],
                "accepted": None if step.accepted is None else step.accepted.added.key,
                "alike": [one.added.key for one in step.alike],
                "of_body": step.of_body,
            }
            for step in ladder.steps
        ],
        "floors": ladder.floors,
        "with_body": ladder.with_body,
    }


def _fit_data(fit: ControlFit) -> dict[str, Any]:
    values = zip(fit.placed, fit.stderr, strict=True)
    return {
        "shift": fit.shift,
        "placed": [
            [*p.key, p.value, error if math.isfinite(error) else None] for p, error in values
        ],
        "errors": fit.errors,
    }


#: makes a fit of its saved data
_ReadFit = Callable[[Mapping[str, Any]], ControlFit]


def _ladder_from(content: Mapping[str, Any], read: _ReadFit) -> ComputerLadder:
    base = here = read(content["base"])
    steps = []
    for one in content["steps"]:
        by_key = {a.added.key: a for a in (_attempt_from(a, read) for a in one["attempts"])}
        alike = tuple(by_key[_key(key)] for key in one["alike"])
        accepted = None if one["accepted"] is None else by_key[_key(one["accepted"])]
        of_body = tuple(_key(key) for key in one.get("of_body", ()))
        steps.append(ComputerStep(here, tuple(by_key.values()), accepted, alike, of_body))
        here = here if accepted is None else accepted.fit
    with_body = bool(content.get("with_body", False))
    return ComputerLadder(base, tuple(steps), dict(content["floors"]), with_body)


def _attempt_from(content: Mapping[str, Any], read: _ReadFit) -> Attempt:
    fit = read(content["fit"])
    rest = (content[n] for n in ("score", "behind", "refused", "probability"))
    return Attempt(fit.placed[-1], fit, *rest)


def _key(content: Sequence[str]) -> Key:
    name, at = content
    return name, at


def _computed_fit(data: ControlData, content: Mapping[str, Any]) -> ControlFit:
    """A fit at the computer's cuts: its errors are those along the records."""
    placed, errors = _placed_from(content, data.part.diagram)
    return data.at(placed, int(content["shift"]), errors)


def _saved_fit(experiment: DiagramExperiment, content: Mapping[str, Any]) -> ControlFit:
    """A fit in the cut of a body, which was estimated with it: its errors are those saved."""
    placed, errors = _placed_from(content, experiment.diagram)
    return ControlFit(tuple(placed), 0, {}, dict(content["errors"]), tuple(errors))


def _placed_from(content: Mapping[str, Any], diagram: Diagram) -> tuple[list[Placed], list[float]]:
    """Effects with their values, and the standard errors of these."""
    blocks = [block.name for block in diagram.blocks]
    free = {p.key: p.effect for p in free_parameters(diagram, blocks)}
    placed = [
        Placed(free.get((name, at)) or CONTROL_EFFECTS[name], at, float(value))
        for name, at, value, _ in content["placed"]
    ]
    return placed, [math.nan if e is None else float(e) for *_, e in content["placed"]]

"""The experiment of a command, and its diagnosis: made now, or read from an answer.

Every command that needs one comes by it here: from the experiment's folder, with `--answer F` from
what `teleopdesign diagnose --json F` has written of it.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import ExperimentError, did_you_mean
from ._options import add_effect_files, add_folder, say

if TYPE_CHECKING:
    from ..blocks import Body
    from ..diagnose import Diagnosis
    from ..effects import Effect
    from ..measurement import Experiment
    from ..model import Model
    from ..realise.reach import Reach


def add_experiment(parser: argparse.ArgumentParser, *, answer: bool = True) -> None:
    """Arguments: the experiment's folder, the user's effects, and an answer to continue from."""
    add_folder(parser)
    if answer:
        add_answer(parser)
    else:
        parser.set_defaults(answer=None)
    add_effect_files(parser)


def add_answer(parser: argparse.ArgumentParser) -> None:
    """The answer that stands for a diagnosis."""
    parser.add_argument(
        "--answer",
        type=Path,
        metavar="F",
        help="an answer of `teleopdesign diagnose --json` for that folder, in place of a diagnosis",
    )


def known_of(options: argparse.Namespace) -> Mapping[str, Effect]:
    """The effects by name, the user's own among them."""
    from ..effects import catalogue

    return catalogue(options.effect)


def experiment_of(folder: Path) -> Experiment:
    """The experiment of a folder; an answer in its place has no records, and a line says so."""
    from ..measurement import load_experiment

    if folder.suffix == ".json" and folder.is_file():
        raise ExperimentError(
            f"{folder}: holds no records: give the folder of its experiment, and --answer {folder}"
        )
    return load_experiment(folder)


def stated_model(experiment: Experiment, options: argparse.Namespace) -> Model:
    """The model that the experiment describes."""
    from ..model import Model

    return Model.from_experiment(experiment, known_of(options))


def diagnosis_of(experiment: Experiment, options: argparse.Namespace) -> Diagnosis:
    """The diagnosis of an experiment: as the answer tells, or made now, with progress said."""
    if options.answer is not None:
        from ..diagnose.answers import load_answer, restored

        return restored(load_answer(options.answer), experiment, known_of(options))
    from ..diagnose import find_missing

    diagnosis = find_missing(experiment, stated_model(experiment, options), progress=say)
    say("")
    return diagnosis


def body_of_source(source: Path, options: argparse.Namespace) -> tuple[Body, Reach | None]:
    """The diagnosed body: of an answer (.json), or of a folder that is diagnosed now and printed.

    An answer holds its model, so it needs no folder; with a folder it is held against the records.
    returns: the body, and what its records reached; None where there are no records
    """
    from ..design.reach import reach_of
    from ..diagnose.answers import load_answer

    if source.suffix == ".json" and not source.is_dir():
        if options.answer is not None:
            raise ExperimentError(f"--answer: found beside {source}, which is an answer itself")
        model = load_answer(source).model(known_of(options))
        return model.bodies[_place(model, source, options.body)], None
    experiment = experiment_of(source)
    place = _place(stated_model(experiment, options), source, options.body)
    if options.answer is not None:
        model = load_answer(options.answer).model(known_of(options), experiment)
    else:
        diagnosis = diagnosis_of(experiment, options)
        print(diagnosis)
        print()
        model = diagnosis.model
    return model.bodies[place], reach_of(experiment, place)


def _place(model: Model, source: Path, body: str | None) -> str:
    """The place of the chosen body; by default the only body."""
    bodies = list(model.bodies)
    if body is None and len(bodies) > 1:
        raise ExperimentError(f"{source}: bodies {', '.join(bodies)}: choose one with --body")
    if body is not None and body not in bodies:
        raise ExperimentError(
            f'--body: no body "{body}", has {", ".join(bodies)}{did_you_mean(body, bodies)}'
        )
    return body or bodies[0]

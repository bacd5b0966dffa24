"""The experiment of a command, and its diagnosis: computed now, or read from an answer.

Every command that needs a diagnosis gets it here. The diagnosis is computed from the experiment's
folder; with `--answer F` it is read from the file that `teleopdesign diagnose --json F` has
written. An answer may also stand alone, or in a folder with `answer.json` and no experiment: it
names the folder of its experiment.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError, ModelError
from ._arms import chosen_body, inertia_line, place_at_pose
from ._terminal import Reporter, print_styled

if TYPE_CHECKING:
    from ..block_cuts import BlockDiagnosis, DiagramExperiment
    from ..blocks import Body
    from ..diagnose import Diagnosis
    from ..effects import Effect
    from ..measurement import Experiment
    from ..model import Model
    from ..passivity.identified import Basis
    from ..realise.reach import Reach


def effects_by_name(options: argparse.Namespace) -> Mapping[str, Effect]:
    """Effect name -> effect: the catalogue and the user's effects."""
    from ..effects import catalogue

    return catalogue(options.effect)


def candidate_effects(
    known: Mapping[str, Effect], only: Sequence[str], exclude: Sequence[str]
) -> tuple[str, ...] | None:
    """Names of the effects that a diagnosis considers; None (all effects) if both lists are empty.

    only: names; all effects if empty;  exclude: names
    raises ModelError: an unknown name, or no effect is left
    """
    from ..effects import find_effect

    if not only and not exclude:
        return None
    for option, names in (("--only", only), ("--exclude", exclude)):
        for name in names:
            if name not in known and Path(name).exists():
                raise ModelError(f'{option}: "{name}" is a file or folder: put it before {option}')
            find_effect(name, known, option)
    remaining = tuple(n for n in known if (not only or n in only) and n not in exclude)
    if not remaining:
        raise ModelError("--exclude: leaves no effect to try")
    return remaining


def experiment_of(folder: Path) -> Experiment:
    """The experiment in a folder, or the experiment of an answer given in place of the folder."""
    from ..measurement import load_experiment

    return load_experiment(folder_of(folder))


def experiment_or_diagram(folder: Path) -> Experiment | DiagramExperiment:
    """The experiment in a folder, of bodies or of a whole diagram."""
    from ..block_cuts import load_experiment

    return load_experiment(folder)


def folder_of(path: Path) -> Path:
    """The path itself if it is not an answer; else the folder of the answer's experiment."""
    answer = answer_in(path)
    if answer is None:
        return path
    from ..diagnose.answer import folder_of_answer

    folder = folder_of_answer(answer)
    return folder.resolve() if ".." in folder.parts else folder


def experiment_and_answer(options: argparse.Namespace) -> Experiment:
    """The experiment of a folder or of an answer; such an answer is stored in `options.answer`.

    raises ExperimentError: there is an answer in `options.answer` already
    """
    answer = answer_in(options.folder)
    if answer is not None:
        if options.answer is not None:
            raise ExperimentError(f"--answer: found beside {answer}, which is an answer itself")
        options.answer, options.folder = answer, folder_of(answer)
    return experiment_of(options.folder)


def answer_in(path: Path) -> Path | None:
    """A path that is an answer, or answer.json of a folder without experiment; else None."""
    if path.suffix == ".json" and not path.is_dir():
        return path
    saved = path / "answer.json"
    if saved.is_file() and not (path / "experiment.toml").exists():
        return saved
    return None


def stated_model(experiment: Experiment, options: argparse.Namespace) -> Model:
    """The model that the experiment describes, with the user's effects."""
    from ..model import Model

    return Model.from_experiment(experiment, effects_by_name(options))


def diagnosis_of(experiment: Experiment, options: argparse.Namespace) -> Diagnosis:
    """The diagnosis of an experiment: read from the answer, or computed now with progress shown."""
    from ..diagnose import Diagnosis, load_answer

    if options.answer is not None:
        return load_answer(options.answer, effects_by_name(options), experiment=experiment)
    diagnosis = diagnose_now(experiment, options)
    assert isinstance(diagnosis, Diagnosis)
    return diagnosis


def diagnosis_of_part(experiment: Experiment, options: argparse.Namespace) -> Diagnosis:
    """As `diagnosis_of`; of an arm that of the joint that the options name."""
    if experiment.arm is None:
        return diagnosis_of(experiment, options)
    joint = chosen_body(experiment.bodies, options, experiment.folder.name)
    return diagnosis_of(experiment, options).joints[joint]


def diagnose_now(
    experiment: Experiment | DiagramExperiment, options: argparse.Namespace
) -> Diagnosis | BlockDiagnosis:
    """The diagnosis of bodies or of a whole diagram, computed now with progress shown.

    The options choose its plan and its candidate effects.
    """
    from ..block_cuts import DiagramExperiment, find_missing
    from ..diagnose.search_plan import PLAN, QUICK

    known = effects_by_name(options)
    diagnosis = find_missing(
        experiment,
        None if isinstance(experiment, DiagramExperiment) else stated_model(experiment, options),
        progress=(reporter := Reporter()),
        plan=QUICK if getattr(options, "quick", False) else PLAN,
        among=candidate_effects(
            known, getattr(options, "only", ()), getattr(options, "exclude", ())
        ),
        known=known,
    )
    reporter.clear()
    return diagnosis


#: beginning of a line of a diagnosis -> its style on a terminal
_STYLES = {
    "verdict: model_adequate": "good",
    "verdict: undecided": "warning",
    "verdict: effects_missing": "strong",
    "+ ": "strong",
    "noise floor": "faint",
    "refused: ": "faint",
    "left out: ": "warning",
}


def print_diagnosis(text: str) -> None:
    """Print a diagnosis in words, in colours on a terminal."""

    def style(line: str) -> str:
        return next((s for begin, s in _STYLES.items() if line.startswith(begin)), "")

    print_styled(text, style)


def read_source(
    options: argparse.Namespace, *, one_body: bool
) -> tuple[Diagnosis, Experiment | None]:
    """The diagnosis of the options' answer or folder; None: an answer alone needs no records.

    one_body: one body must be chosen; a wrong choice is refused before any diagnosis
    """
    from ..diagnose import load_answer

    alone = answer_in(options.folder)
    if alone is not None and options.answer is None:
        options.answer = alone
        return load_answer(alone, effects_by_name(options)), None
    experiment = experiment_and_answer(options)
    if one_body or options.body is not None or experiment.arm is not None:
        chosen_body(experiment.bodies, options, options.folder)
    return diagnosis_of(experiment, options), experiment


def model_of_source(options: argparse.Namespace) -> tuple[Model, Path]:
    """The diagnosed model, and the answer or folder from which it comes; for an arm, of one joint.

    An answer alone (.json) needs no records. A folder without an answer is diagnosed now.
    """
    diagnosis, _ = read_source(options, one_body=False)
    source = options.answer or options.folder
    if options.body is None and not diagnosis.joints:
        return diagnosis.model, source
    return model_at_place(diagnosis, options), source


def model_at_place(diagnosis: Diagnosis, options: argparse.Namespace) -> Model:
    """The final model of one body; for a joint of an arm, at the pose that the options state."""
    from ..diagnose.model_data import model_of_body

    place = chosen_body(diagnosis.model.bodies, options, options.answer or options.folder)
    if diagnosis.joints:
        return place_at_pose(diagnosis, place, options)
    return model_of_body(diagnosis.model, place)


def body_of_source(source: Path, options: argparse.Namespace) -> tuple[Body, Reach | None, Basis]:
    """The diagnosed body of an answer (.json), or of a folder, which is diagnosed now and printed.

    An answer contains its model, so it needs no folder. With a folder and `--answer`, the model of
    the answer is used with the records of the folder.

    returns: the body, the range that its records reached (None without records), and what limits
        of its friction rest on
    """
    from ..design.assumptions import reach_of

    options.folder = source
    diagnosis, experiment = read_source(options, one_body=True)
    if options.answer is None:
        print_diagnosis(str(diagnosis))
        print()
    model = model_at_place(diagnosis, options)
    ((place, body),) = model.bodies.items()
    if experiment is None:
        return body, None, basis_of(diagnosis, place)
    if diagnosis.joints:
        print(inertia_line(model, place, options))
        experiment = diagnosis.joints[place].experiment
    return body, reach_of(experiment, place), basis_of(diagnosis, place)


def basis_of(diagnosis: Diagnosis, place: str) -> Basis:
    """What limits of the friction of a body rest on.

    An older answer has no friction by cells: the records of its experiment show it, if they are
    found. An arm's joint has none.
    """
    from ..diagnose.friction_cells import friction_cells
    from ..passivity.identified import Basis
    from ..realise.friction_cells import FrictionCells

    is_adequate = not diagnosis.more_is_missing
    cells = diagnosis.friction_cells.get(place, ())
    if not cells and not is_adequate and not diagnosis.joints:
        try:
            cells = friction_cells(diagnosis.model, diagnosis.prepared, place)
        except ExperimentError:
            pass  # no records: the limits then say that none is certain
    shown = FrictionCells(cells) if cells else None
    return Basis(diagnosis.verdict, diagnosis.left, is_adequate, shown)

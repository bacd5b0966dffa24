"""The experiment of a command, and its diagnosis: computed now, or read from an answer.

Every command that needs a diagnosis gets it here. The diagnosis is computed from the experiment's
folder; with `--answer F` it is read from the file that `teleopdesign diagnose --json F` has
written. An answer may also stand alone, or in a folder with `answer.json` and no experiment: it
names the folder of its experiment.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ..base.errors import ExperimentError, ModelError, did_you_mean
from ._arms import inertia_line, joint_of, place_at_pose
from ._progress import Reporter
from ._terminal import print_styled

if TYPE_CHECKING:
    from ..blocks import Body
    from ..diagnose import ArmDiagnosis, Diagnosis
    from ..effects import Effect
    from ..measurement import Experiment
    from ..model import Model
    from ..passivity.identified import Basis
    from ..realise.reach import Reach

#: of one or two bodies, or of an arm
Diagnosed = TypeVar("Diagnosed", bound="Diagnosis | ArmDiagnosis")


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


def folder_of(path: Path) -> Path:
    """The path itself if it is not an answer; else the folder of the answer's experiment."""
    answer = _answer_in(path)
    if answer is None:
        return path
    from ..diagnose.answers import load_answer

    return load_answer(answer).folder


def experiment_and_answer(options: argparse.Namespace) -> Experiment:
    """The experiment of a folder or of an answer; such an answer is stored in `options.answer`.

    raises ExperimentError: there is an answer in `options.answer` already
    """
    answer = _answer_in(options.folder)
    if answer is None:
        return experiment_of(options.folder)
    if options.answer is not None:
        raise ExperimentError(f"--answer: found beside {answer}, which is an answer itself")
    from ..diagnose.answers import load_answer

    options.answer, options.folder = answer, load_answer(answer).folder
    return experiment_of(options.folder)


def _answer_in(path: Path) -> Path | None:
    """A path that is an answer, or answer.json of a folder without experiment; else None."""
    if path.suffix == ".json" and path.is_file():
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
    """The diagnosis of an experiment: read from the answer, or computed now with progress shown.

    For an arm, the diagnosis of the joint that the options name.
    """
    if experiment.arm is not None:
        joint = joint_of(experiment, options)
        return arm_diagnosis_of(experiment, options).joints[joint]
    if options.answer is not None:
        from ..diagnose.answers import load_answer, restore_diagnosis

        return restore_diagnosis(load_answer(options.answer), experiment, effects_by_name(options))
    return diagnose_experiment(experiment, options)


def diagnose_experiment(experiment: Experiment, options: argparse.Namespace) -> Diagnosis:
    """The diagnosis of an experiment, computed now with progress shown."""
    from ..diagnose import find_missing

    return search_missing(find_missing, experiment, options)


def arm_diagnosis_of(experiment: Experiment, options: argparse.Namespace) -> ArmDiagnosis:
    """The diagnosis of an arm: read from the answer, or computed now with progress shown."""
    from ..diagnose.answers import load_answer
    from ..diagnose.arms import find_missing_in_arm
    from ..diagnose.arms.restored import restore_arm_diagnosis

    if options.answer is not None:
        return restore_arm_diagnosis(
            load_answer(options.answer), experiment, effects_by_name(options)
        )
    return search_missing(find_missing_in_arm, experiment, options)


def search_missing(
    find: Callable[..., Diagnosed], experiment: Experiment, options: argparse.Namespace
) -> Diagnosed:
    """The result of a search, with the plan and the candidate effects that the options choose.

    find: `find_missing` or `find_missing_in_arm`
    """
    from ..diagnose.search_plan import PLAN, QUICK

    among = candidate_effects(
        effects_by_name(options), getattr(options, "only", ()), getattr(options, "exclude", ())
    )
    model = stated_model(experiment, options)
    plan = QUICK if getattr(options, "quick", False) else PLAN
    reporter = Reporter()
    diagnosis = find(experiment, model, progress=reporter, plan=plan, among=among)
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


def print_diagnosis(diagnosis: Diagnosis | ArmDiagnosis) -> None:
    """Print the ladder and the verdict, in colours on a terminal."""

    def style(line: str) -> str:
        return next((s for begin, s in _STYLES.items() if line.startswith(begin)), "")

    print_styled(str(diagnosis), style)


def model_of_source(options: argparse.Namespace) -> tuple[Model, Path]:
    """The diagnosed model, and the answer or folder from which it comes; for an arm, of one joint.

    An answer alone (.json) needs no records. A folder without an answer is diagnosed now.
    """
    from ..diagnose.answers import load_answer

    alone = _answer_in(options.folder)
    if alone is not None and options.answer is None:
        model = _model_of_answer(alone, options)
        return (model if options.body is None else _select_body(model, options.body, alone)), alone
    experiment = experiment_and_answer(options)
    if options.answer is not None:
        model = load_answer(options.answer).model(effects_by_name(options), experiment)
    else:
        model = diagnosis_of(experiment, options).model
    source = options.folder if options.answer is None else options.answer
    if experiment.arm is not None:
        return place_at_pose(model, experiment, joint_of(experiment, options), options), source
    return (model if options.body is None else _select_body(model, options.body, source)), source


def _model_of_answer(file: Path, options: argparse.Namespace) -> Model:
    """The model in an answer alone; for an arm, the model of the joint that the options name."""
    from ..diagnose.answers import load_answer

    saved = load_answer(file)
    model = saved.model(effects_by_name(options))
    if "joints" not in saved.content:
        return model
    joint = _place(model, file, options.body)
    if not options.pose:
        return _select_body(model, joint, file)
    return place_at_pose(model, experiment_of(saved.folder), joint, options)


def _select_body(model: Model, body: str, source: Path) -> Model:
    """The model of one body of several bodies."""
    from ..model import Model

    place = _place(model, source, body)
    return Model({place: model.bodies[place]}, model.known)


def body_of_source(source: Path, options: argparse.Namespace) -> tuple[Body, Reach | None, Basis]:
    """The diagnosed body of an answer (.json), or of a folder, which is diagnosed now and printed.

    An answer contains its model, so it needs no folder. With a folder and `--answer`, the model of
    the answer is used with the records of the folder.

    returns: the body, the range that its records reached (None without records), and what limits
        of its friction rest on
    """
    from ..design.stated_motion import reach_of
    from ..diagnose.answers import load_answer
    from ._basis import basis_of_answer, basis_of_diagnosis

    if source.suffix == ".json" and not source.is_dir():
        if options.answer is not None:
            raise ExperimentError(f"--answer: found beside {source}, which is an answer itself")
        model = _model_of_answer(source, options)
        place = _place(model, source, options.body)
        return model.bodies[place], None, basis_of_answer(load_answer(source), model, place)
    experiment = experiment_of(source)
    place = _place(stated_model(experiment, options), source, options.body)
    if options.answer is not None:
        saved = load_answer(options.answer)
        model = saved.model(effects_by_name(options), experiment)
        basis = basis_of_answer(saved, model, place, experiment)
    else:
        diagnosis = diagnosis_of(experiment, options)
        print_diagnosis(diagnosis)
        print()
        model, basis = diagnosis.model, basis_of_diagnosis(diagnosis, place)
    if experiment.arm is not None:
        from ..diagnose.arms.prepared import isolate_joint

        model = place_at_pose(model, experiment, place, options)
        print(inertia_line(model, place, options))
        experiment = isolate_joint(experiment, place)
    return model.bodies[place], reach_of(experiment, place), basis


def _place(model: Model, source: Path, body: str | None) -> str:
    """The place of the chosen body; by default the only body.

    raises ExperimentError: no such body, or several bodies and none is chosen
    """
    bodies = list(model.bodies)
    if body is None and len(bodies) > 1:
        raise ExperimentError(f"{source}: bodies {', '.join(bodies)}: choose one with --body")
    if body is not None and body not in bodies:
        raise ExperimentError(
            f'--body: no body "{body}", has {", ".join(bodies)}{did_you_mean(body, bodies)}'
        )
    return body or bodies[0]

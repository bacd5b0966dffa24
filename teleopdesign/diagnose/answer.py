"""An answer as a file: a diagnosis as JSON, in the format that users and other programs read.

    write_answer(diagnosis, "answer.json")
    load_answer("answer.json")                 # equals the diagnosis that was written

The keys are the fields of `Diagnosis`, except for two: the models of the ladder stand apart, under
`models`, and `experiment` holds the folder of the experiment too, relative to the file.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, NoReturn

from ..base.arguments import check_types
from ..base.codec import At, DataForm, DataForms, from_data, to_data
from ..base.errors import ExperimentError, ModelError, did_you_mean, quote
from ..base.files import read_whole, write_json
from ..blocks import with_block_effects
from ..effects import EFFECTS, Effect
from ..measurement.experiment import Experiment
from ..model import Model
from .by_simulation import SimulationComparison, simulation_data
from .candidates import Candidate
from .diagnosis import Diagnosis
from .model_data import Place, known_effect, model_data, model_from, place_data
from .older_answers import upgrade_content
from .recording import DiagnosedRecording

WRITER = "an answer of `teleopdesign diagnose --json`"


def answer(diagnosis: Diagnosis) -> dict[str, Any]:
    """The answer as plain data: verdict, ladder, candidates, parameters; SI units."""
    forms = {
        Model: DataForm(model_data, _refuse_reading),
        Candidate: DataForm(place_data, _refuse_reading),
    }
    return _with_models_apart(to_data(diagnosis, forms))


def _refuse_reading(data: Any, where: str) -> NoReturn:
    raise AssertionError(f"{where}: {data!r} is written only")


def _with_models_apart(content: dict[str, Any]) -> dict[str, Any]:
    """The content, with the models of all rows in one list; of the joints of an arm as well."""
    models = [row.pop("model") for row in content["ladder"]]
    content["models"] = {"ladder": models, **content["models"]}
    for joint in content.get("joints", {}).values():
        _with_models_apart(joint)
    return content


def write_answer(
    diagnosis: Diagnosis, path: str | Path, *, simulation: SimulationComparison | None = None
) -> None:
    """Write the answer as JSON, with the path of its experiment relative to the answer.

    simulation: a comparison by simulation, where one was made
    """
    if simulation is not None:
        diagnosis = replace(diagnosis, simulation=simulation_data(simulation))
    content, folder = answer(diagnosis), diagnosis.experiment.folder
    if folder.is_dir():  # an experiment of arrays has none
        place = os.path.relpath(folder.resolve(), Path(path).resolve().parent)
        content["experiment"]["folder"] = Path(place).as_posix()
    write_json(path, content)


@check_types
def load_answer(
    path: str | Path,
    known: Mapping[str, Effect] = EFFECTS,
    *,
    experiment: Experiment | None = None,
) -> Diagnosis:
    """The diagnosis in an answer that `teleopdesign diagnose --json` or `write_answer` wrote.

    Nothing is searched or estimated again. Of an answer of an earlier version the final model is
    there, and what else it holds.
    known: effects by name, with those of the user
    experiment: of this answer; None: it is read from the folder that the answer names, when it is
        first needed
    raises ExperimentError: the file cannot be read, is no answer or one to another experiment, or
        an effect is unknown
    """
    return diagnosis_in(content_of_answer(path), path, known, experiment=experiment)


def diagnosis_in(
    content: dict[str, Any],
    path: str | Path,
    known: Mapping[str, Effect] = EFFECTS,
    *,
    experiment: Experiment | None = None,
) -> Diagnosis:
    """The diagnosis in the content of an answer;  path: of its file.

    raises ExperimentError: as `load_answer`
    """
    try:
        diagnosis = _diagnosis_from(content, known, experiment)
        recording = replace(_recording_of(content, path), stated=experiment)
    except (ExperimentError, ModelError) as error:
        raise ExperimentError(f"{path}: {error}") from error
    diagnosis = with_recording(diagnosis, replace(recording, fingerprint=diagnosis.fingerprint))
    if experiment is not None:
        diagnosis.recording.require(experiment)
    return diagnosis


def folder_of_answer(path: str | Path) -> Path:
    """The folder of the experiment that an answer belongs to; the effects of its models may be any.

    raises ExperimentError: the file is no answer, or there is no such folder
    """
    return _recording_of(content_of_answer(path), path).place


@dataclass(frozen=True)
class _Whereabouts:
    """The part of an answer that says where its experiment is."""

    verdict: str
    folder: Annotated[str | None, At("experiment.folder")] = None


def _recording_of(content: Any, path: str | Path) -> DiagnosedRecording:
    folder = from_data(_Whereabouts, content, "", {}, whole=WRITER).folder
    return DiagnosedRecording(folder=folder, file=str(path))


def with_recording(diagnosis: Diagnosis, recording: DiagnosedRecording) -> Diagnosis:
    """The diagnosis with the recording that it belongs to, and so those of an arm's joints."""
    bandwidth = diagnosis.bandwidth
    here = replace(
        recording,
        bandwidth=bandwidth if bandwidth == bandwidth else None,
        model=diagnosis.after.fitted,
        other_motion=diagnosis.other_motion,
    )
    joints = {
        name: replace(one, recording=here.of_joint(name, one.after.fitted))
        for name, one in diagnosis.joints.items()
    }
    return replace(diagnosis, recording=here, joints=joints)


def content_of_answer(path: str | Path) -> dict[str, Any]:
    """The content of a JSON file.

    raises ExperimentError: the file cannot be read, or is no JSON
    """
    try:
        content = json.loads(read_whole(path).decode("utf-8-sig"), parse_constant=_constant)
    except OSError as error:
        raise ExperimentError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ExperimentError(f"{path}: not UTF-8 text (byte {error.start})") from None
    except json.JSONDecodeError as error:
        raise ExperimentError(f"{path}: line {error.lineno}: no JSON: {error.msg}") from None
    except RecursionError:
        raise ExperimentError(f"{path}: brackets nested too deeply") from None
    except ValueError as error:  # a number too long to convert, NaN, a null character in the path
        raise ExperimentError(f"{path}: no JSON: {error}") from None
    try:
        from_data(_Whereabouts, content, "", {}, whole=WRITER)
    except ExperimentError as error:
        raise ExperimentError(f"{path}: {error}") from None
    return content  # type: ignore[no-any-return]


def _constant(name: str) -> NoReturn:
    raise ValueError(f"found {name}, expected a finite number or null")


def _diagnosis_from(
    content: dict[str, Any], known: Mapping[str, Effect], experiment: Experiment | None
) -> Diagnosis:
    """The diagnosis that the content of a file describes.

    raises ExperimentError: with the key in front, without the file
    """
    content = upgrade_content(content, known, experiment, whole=WRITER)
    names = from_data(tuple[str, ...], content.get("considered", []), "considered", {})
    effects, considered = with_block_effects(known), {n: known[n] for n in names if n in known}
    may_take = considered if 0 < len(considered) < len(known) else known

    def read_model(data: Any, where: str) -> Model:
        if isinstance(data, Model):
            return data
        return model_from(data, known, where, may_take=may_take)

    def read_candidate(data: Any, where: str) -> Candidate:
        place = from_data(Place, data, where, {})
        return Candidate(known_effect(place.effect, effects, where=where), place.at)

    forms = {
        Model: DataForm(model_data, read_model),
        Candidate: DataForm(place_data, read_candidate),
    }
    joined = _with_models_beside(content, forms)
    diagnosis: Diagnosis = from_data(Diagnosis, joined, "", forms, whole=WRITER)
    _check_parts(diagnosis)
    return diagnosis


def _with_models_beside(content: dict[str, Any], forms: DataForms, at: str = "") -> dict[str, Any]:
    """The content, with each model beside the errors of its row; at: place of the content."""
    models = from_data(_Models, content["models"], f"{at}models", forms).ladder
    rows = content["ladder"]
    if len(models) != len(rows):
        raise ExperimentError(
            f"{at}models.ladder: found {len(models)} models, expected {len(rows)}, one for each "
            "row of the ladder"
        )
    if models[-1] is None:
        raise ExperimentError(f"{at}models.ladder[{len(models)}]: found null, expected a table")
    joints = {
        name: _with_models_beside(one, forms, f"{at}joints.{name}.")
        for name, one in content.get("joints", {}).items()
    }
    pairs = zip(rows, models, strict=True)
    return content | {"ladder": [row | {"model": m} for row, m in pairs], "joints": joints}


@dataclass(frozen=True)
class _Models:
    ladder: tuple[Model | None, ...]


def _check_parts(diagnosis: Diagnosis, at: str = "") -> None:
    """Refuse parts that contradict each other.

    at: place of the diagnosis in the file
    raises ExperimentError: with both in words
    """
    first, *others = diagnosis.rungs
    if first.added is not None or any(r.added is None for r in others):
        raise ExperimentError(
            f"{at}ladder: expected the user's model first (added: null), then effects"
        )
    if first.instead_of is not None:
        raise ExperimentError(f"{at}ladder: instead_of: found it beside added: null")
    last = [m for m in (diagnosis.after.fitted, diagnosis.estimated) if m is not None]
    for row in others:
        if row.added is not None:
            _require_effect(row.added, last, f"{at}ladder")
        if row.instead_of is not None and first.fitted is not None and row.added is not None:
            there = first.model.body(row.added.at)
            if not there.has(row.instead_of):
                raise ExperimentError(f"{at}ladder: instead_of: no {quote(row.instead_of)} there")
    for question in diagnosis.open or ():
        if question.added is not None:
            _require_effect(question.added, last, f"{at}open")
        for rival in question.others:
            _require_effect(rival.candidate, [rival.model], f"{at}open")
    for name in diagnosis.at_bound:
        if any(name not in model.parameters for model in last):
            raise ExperimentError(f"{at}at_bound: the model has no parameter {quote(name)}")
    _check_joints(diagnosis, at)


def _check_joints(diagnosis: Diagnosis, at: str) -> None:
    """Refuse an arm whose joints are not those of its model, or lack an effect of its ladder."""
    joints = diagnosis.joints
    if not joints:
        return
    for joint in diagnosis.model.bodies:
        if joint not in joints:
            raise ExperimentError(
                f"{at}joints: no joint {quote(joint)}, has {', '.join(joints) or 'none'}"
                f"{did_you_mean(joint, joints)}"
            )
    for joint, one in joints.items():
        _check_parts(one, f"{at}joints.{joint}.")
    added = {r.added.key for one in joints.values() for r in one.rungs if r.added is not None}
    for row in diagnosis.rungs:
        if row.added is not None and row.added.key not in added:
            raise ExperimentError(f"{at}ladder: {row.added}: no joint's own ladder has it")


def _require_effect(candidate: Candidate, models: Sequence[Model], where: str) -> None:
    """Refuse a candidate of which a model that should have its effect has none."""
    for model in models:
        try:
            there = model.body(candidate.at).has(candidate.effect.name)
        except ModelError as error:
            raise ExperimentError(f"{where}: {candidate}: {error}") from error
        if not there:
            raise ExperimentError(f"{where}: {candidate}: its model has no such effect")

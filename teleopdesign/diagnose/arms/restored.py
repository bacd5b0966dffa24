"""Read the diagnosis of an arm back from its answer file, without a new search or fit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...base.errors import ExperimentError, did_you_mean, quote
from ...effects import EFFECTS, Effect
from ...measurement.experiment import Experiment
from ...model import Model
from ..answers import SavedAnswer
from ..answers.bodies import model_from
from ..answers.restored import error_from, evaluate_fit, restore_diagnosis, with_errors_of
from ..diagnosis import Diagnosis
from ..rung import Rung
from .diagnosis import ArmDiagnosis, ArmRung
from .fit import ArmFit
from .other_motion import with_other_motions
from .prepared import PreparedArm, isolate_joint, prepare_arm, with_bodies_of


def restore_arm_diagnosis(
    saved: SavedAnswer, experiment: Experiment, known: Mapping[str, Effect] = EFFECTS
) -> ArmDiagnosis:
    """The diagnosis of an arm in an answer; residuals are computed, nothing is estimated.

    known: effects by name, with those of the user
    raises ExperimentError: the answer is to another experiment, or of an earlier version
    """
    if "models" not in saved.content:
        raise ExperimentError(
            f'{saved.file}: no key "models": the answer of an earlier version: diagnose anew'
        )
    saved.require(experiment)
    prepared = prepare_arm(experiment)
    models = _models(saved, experiment, prepared, known)
    prepared = with_bodies_of(models[-1], prepared)
    prepared = with_other_motions(prepared, _other_joints(saved, prepared))
    joints = {
        j: restore_diagnosis(
            saved.of_joint(j), isolate_joint(experiment, j), known, records=records
        )
        for j, records in prepared.joints.items()
    }
    rows = saved.content["ladder"]
    added = _rungs_by_addition(joints)
    rungs = tuple(
        _rung(row, model, prepared, added, f"{saved.file}: ladder")
        for row, model in zip(rows, models, strict=True)
    )
    errors = _link_errors(saved, prepared)
    return ArmDiagnosis(experiment, prepared, saved.verdict, rungs, joints, errors)


def _other_joints(saved: SavedAnswer, prepared: PreparedArm) -> dict[str, str]:
    """Joint -> the joint whose motion is its channel `other_position`.

    raises ExperimentError: one of these is no joint of the arm
    """
    others: dict[str, str] = saved.content.get("other_motion", {})
    for joint in (*others, *others.values()):
        if joint not in prepared.joints:
            raise ExperimentError(
                f"{saved.file}: other_motion: no joint {quote(joint)}, has "
                f"{', '.join(prepared.joints)}{did_you_mean(joint, prepared.joints)}"
            )
    return others


def _models(
    saved: SavedAnswer, experiment: Experiment, prepared: PreparedArm, known: Mapping[str, Effect]
) -> list[Model]:
    """The model of all joints on each rung.

    raises ExperimentError: their number, bodies or base parameters do not fit
    """
    entries = saved.content["models"]["ladder"]
    if len(entries) != len(saved.content["ladder"]):
        raise ExperimentError(
            f"{saved.file}: models.ladder: found {len(entries)} models, expected "
            f"{len(saved.content['ladder'])}, one for each row of the ladder"
        )
    models = [model_from(data, known, file=saved.file, key="models.ladder") for data in entries]
    count = len(prepared.initial)
    for model in models:
        saved.require_bodies(model, experiment)
        if len(model.links) != count:
            raise ExperimentError(
                f"{saved.file}: models.ladder: found {len(model.links)} base parameters, expected "
                f"{count} as the links of {experiment.folder.name} have"
            )
    return models


def _rungs_by_addition(joints: Mapping[str, Diagnosis]) -> dict[tuple[str, str], Rung]:
    """(effect, joint) -> the rung of that joint's ladder that added the effect."""
    return {r.added.key: r for d in joints.values() for r in d.rungs if r.added is not None}


def _rung(
    row: Mapping[str, Any],
    model: Model,
    prepared: PreparedArm,
    added: Mapping[tuple[str, str], Rung],
    where: str,
) -> ArmRung:
    """A rung of the arm's ladder, with the errors that the answer states."""
    fits, errors = {}, row["joints"]
    for j, records in prepared.joints.items():
        shifts = {n: late for n, late in model.record_shift.items() if n == j}
        mine = Model({j: model.bodies[j]}, model.known, shifts).with_links(model.links)
        fits[j] = with_errors_of(errors[j], evaluate_fit(mine, records))
    fit = ArmFit(
        fits=fits,
        prepared=prepared.joints,
        links=model.links,
        fit_errors={j: f.fit_error for j, f in fits.items()},
        check_errors={j: f.check_error for j, f in fits.items()},
    )
    if row["added"] is None:
        return ArmRung(None, fit)
    key = row["added"]["effect"], row["added"]["at"]
    if key not in added:
        raise ExperimentError(f"{where}: {key[0]} at {key[1]}: no joint's own ladder has it")
    return ArmRung(added[key].added, fit, added[key].instead_of, prepared.others.get(key[1]))


def _link_errors(saved: SavedAnswer, prepared: PreparedArm) -> tuple[float, ...]:
    """Standard errors of the base parameters."""
    if prepared.base is None:
        return ()
    rows = saved.content["model_parameters"]
    errors = [rows.get(f"arm.{name}", {}).get("stderr") for name in prepared.base.names]
    return tuple(map(error_from, errors))

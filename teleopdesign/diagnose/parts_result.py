"""The diagnosis of all parts, from the ladders of the parts and that of the whole arm."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from ..measurement.reading import reading_data
from ..model import Model
from .answer import with_recording
from .diagnosis import Diagnosis
from .learnable import Learnable
from .link_knowledge import link_errors
from .noise_floor import NoiseFloor
from .other_motion import with_other_motions
from .parts import PreparedParts, mean_inertias, with_bodies_of
from .parts_fit import PartsRung, error_over_joints, with_body_inertia
from .recording import DiagnosedRecording, fingerprint_of
from .statements import EstimatedValue, JointErrors, LadderRow, VerdictName, finite


def diagnosis_of_parts(
    prepared: PreparedParts,
    rungs: tuple[PartsRung, ...],
    joints: Mapping[str, Diagnosis],
    stated: Model,
) -> Diagnosis:
    """What the search over all parts states.

    rungs: of the whole arm;  joints: part -> its own diagnosis
    stated: the user's model
    """
    experiment = prepared.experiment
    if not prepared.joints:
        (whole,) = joints.values()
        return whole
    each, named = joints.values(), {c.key for d in joints.values() for c in d.missing}
    first = next(iter(each))
    rows = tuple(_row(rung, joints, named) for rung in rungs)
    ours = {row.added.key for row in rows if row.added is not None}
    diagnosis = Diagnosis(
        verdict=_verdict(each),
        rungs=rows,
        floor=_floor(joints),
        candidates=tuple(
            sorted((c for d in each for c in d.candidates), key=lambda c: -c.probability)
        ),
        indistinguishable=tuple(
            group for d in each for group in d.indistinguishable if group[0].key in ours
        ),
        check=first.check,
        held_out=first.held_out,
        bandwidth=prepared.bandwidth,
        bandwidth_source=first.bandwidth_source,
        undetermined=tuple(one for d in each for one in d.undetermined),
        set_aside=tuple(one for d in each for one in d.set_aside),
        record_shift={log: shift for d in each for log, shift in d.record_shift.items()},
        learnable=_learnable(joints),
        at_bound=tuple(name for d in each for name in d.at_bound),
        fingerprint=fingerprint_of(experiment),
        reading=tuple(reading_data(experiment.reading)),
        estimated=rows[-1].model,
        open=(),
        silence=prepared.silence,
        left_out=tuple(dict.fromkeys(words for d in each for words in d.left_out)),
        considered=first.considered,
        joints=joints,
        other_motion=dict(prepared.others),
        links=_links(rungs[-1], prepared),
    )
    motors = {j: stated.parameters[f"{j}.inertia"].value for j in joints}
    diagnosis = _with_final_bodies(diagnosis, prepared, motors)
    whole = with_recording(diagnosis, DiagnosedRecording(stated=experiment))
    whole.recording.__dict__["parts"] = with_other_motions(
        with_bodies_of(whole.model, prepared), prepared.others
    )
    return whole


def _verdict(joints: Collection[Diagnosis]) -> VerdictName:
    verdicts = {d.verdict for d in joints}
    if "effects_missing" in verdicts:
        return "effects_missing"
    return "model_adequate" if verdicts == {"model_adequate"} else "undecided"


def _row(
    rung: PartsRung, joints: Mapping[str, Diagnosis], named: Collection[tuple[str, str]]
) -> LadderRow:
    """A row of the arm's ladder; its look-alikes are those of the joint's own row."""
    fit, added = rung.fit, rung.added
    of_joint = None
    if added is not None:
        of_joint = next((r for r in joints[added.at].rungs if r.added == added), None)
    return LadderRow(
        added=added,
        fit_error=finite(fit.fit_error),
        check_error=finite(fit.check_error),
        fitted=fit.model,
        blind=max(one.blind for one in fit.fits.values()),
        instead_of=None if rung.instead_of is None else rung.instead_of.effect.name,
        alternatives=() if of_joint is None else of_joint.alternatives,
        named=added is not None and added.key in named,
        follows=rung.follows,
        joints={
            j: JointErrors(finite(fit.fit_errors[j]), finite(fit.check_errors[j])) for j in fit.fits
        },
    )


def _floor(joints: Mapping[str, Diagnosis]) -> NoiseFloor:
    """The noise floor of an arm: root mean square over joints, like its errors."""
    value, drawn = (
        error_over_joints({j: getattr(d.floor, name) for j, d in joints.items()})
        for name in ("value", "drawn")
    )
    source = next(iter(joints.values())).floor.source
    return NoiseFloor(value, source, drawn)


def _learnable(joints: Mapping[str, Diagnosis]) -> Learnable | None:
    """The part of all joints' residuals that could be learned; None without the extra `learn`.

    Errors are over all joints, as in the ladder; each joint's diagnosis says where the learned
    force lies.
    """
    boxes = {j: d.learnable for j, d in joints.items() if d.learnable is not None}
    if len(boxes) < len(joints):
        return None
    # trees that make a joint worse are not used there
    return Learnable(
        left=error_over_joints({j: b.left for j, b in boxes.items()}),
        error=error_over_joints({j: min(b.error, b.left) for j, b in boxes.items()}),
        alone=error_over_joints({j: b.alone for j, b in boxes.items()}),
    )


def _links(last: PartsRung, prepared: PreparedParts) -> dict[str, EstimatedValue]:
    """The base parameters by name; empty where none is estimated."""
    base = prepared.base
    if base is None:
        return {}
    models = {j: fit.model for j, fit in last.fit.fits.items()}
    errors = link_errors(models, last.fit.prepared, prepared).tolist()
    rows = zip(base.names, last.fit.links, errors, base.units, strict=True)
    return {name: EstimatedValue(finite(x), finite(e), unit) for name, x, e, unit in rows}


def _with_final_bodies(
    diagnosis: Diagnosis, prepared: PreparedParts, motors: Mapping[str, float]
) -> Diagnosis:
    """The diagnosis with the mean inertia of its final links at each joint; all residuals are kept.

    motors: joint -> stated inertia of its motor
    Where a structure divides a joint's body, the joint keeps its inertia: there the residual
    depends on it.
    """
    means = mean_inertias(prepared, diagnosis.model.links)
    whole = {j: means[j] + motors[j] for j, one in diagnosis.joints.items() if not _is_parted(one)}
    moved = _with_inertias(diagnosis, whole)
    joints = {j: _with_inertias(one, whole) for j, one in diagnosis.joints.items()}
    return replace(moved, joints=joints)


def _is_parted(diagnosis: Diagnosis) -> bool:
    """Whether a model of a joint's ladder, or a rival of one, has a structure."""
    models = [r.model for r in diagnosis.rungs]
    models += [rival.model for q in diagnosis.questions for rival in q.others]
    return any(e.role == "structure" for m in models for b in m.bodies.values() for e in b.effects)


def _with_inertias(diagnosis: Diagnosis, whole: Mapping[str, float]) -> Diagnosis:
    """The diagnosis with other inertias in all of its models; whole: joint -> inertia."""

    def moved(model: Model) -> Model:
        for joint in [j for j in whole if j in model.bodies]:
            model = with_body_inertia(model, joint, whole[joint])
        return model

    questions = tuple(
        replace(q, others=tuple(replace(r, model=moved(r.model)) for r in q.others))
        for q in diagnosis.questions
    )
    return replace(
        diagnosis,
        rungs=tuple(replace(r, fitted=moved(r.model)) for r in diagnosis.rungs),
        estimated=None if diagnosis.estimated is None else moved(diagnosis.estimated),
        open=questions,
    )

"""The joints of an arm as bodies: each has the mean inertia of the links that it moves.

So structures and checks of plausibility get a body of the inertia that moves, and a joint can be
separated from its arm. The inertia of the body is subtracted from the force of the links, so
residuals do not change. Links that were misled by a missing effect have a wrong inertia first; in
the end the inertia is that of the final links.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...model import Model
from ..diagnosis import Diagnosis
from ..fit import Fit
from ..open_questions import open_questions
from .diagnosis import ArmDiagnosis, ArmRung
from .fit import ArmFit
from .prepared import PreparedArm, mean_inertias, with_inertia, with_inertias


def as_bodies(prepared: PreparedArm, first: ArmFit) -> tuple[PreparedArm, dict[str, Model]]:
    """Records and models in which each joint's body has the mean inertia of its links.

    first: the fit that the base parameters of the links are those of
    """
    links = mean_inertias(prepared, first.links)
    models = {}
    for j, fit in first.fits.items():
        motor = fit.model.parameters[f"{j}.inertia"].value
        models[j] = _with_inertia(fit.model, j, links[j] + motor)
    return with_inertias(prepared, links), models


def with_final_bodies(diagnosis: ArmDiagnosis, motors: Mapping[str, float]) -> ArmDiagnosis:
    """The diagnosis with the mean inertia of its final links at each joint; all residuals are kept.

    motors: joint -> stated inertia of its motor
    Where a structure divides a joint's body, the joint keeps its inertia: there the residual
    depends on it.
    """
    means = mean_inertias(diagnosis.prepared, diagnosis.after.links)
    links = {j: x for j, x in means.items() if not _is_parted(diagnosis.joints[j])}
    whole = {j: x + motors[j] for j, x in links.items()}
    parts = {j: with_inertia(diagnosis.prepared.joints[j], x) for j, x in links.items()}
    return replace(
        diagnosis,
        prepared=replace(diagnosis.prepared, joints={**diagnosis.prepared.joints, **parts}),
        rungs=tuple(_rung(r, links, whole) for r in diagnosis.rungs),
        joints={
            j: _joint(d, j, links[j], whole[j]) if j in links else d
            for j, d in diagnosis.joints.items()
        },
    )


def _is_parted(diagnosis: Diagnosis) -> bool:
    """Whether a model of a joint's ladder, or a rival of one, has a structure."""
    models = [r.fit.model for r in diagnosis.rungs]
    models += [fit.model for q in open_questions(diagnosis) for _, fit in q.others]
    return any(e.role == "structure" for m in models for b in m.bodies.values() for e in b.effects)


def _rung(rung: ArmRung, links: Mapping[str, float], whole: Mapping[str, float]) -> ArmRung:
    fits = {j: _fit(f, j, whole[j]) if j in whole else f for j, f in rung.fit.fits.items()}
    records = {
        j: with_inertia(p, links[j]) if j in links else p for j, p in rung.fit.prepared.items()
    }
    return replace(rung, fit=replace(rung.fit, fits=fits, prepared=records))


def _joint(diagnosis: Diagnosis, joint: str, links: float, whole: float) -> Diagnosis:
    questions = tuple(
        replace(q, others=tuple((c, _fit(f, joint, whole)) for c, f in q.others))
        for q in open_questions(diagnosis)
    )
    return replace(
        diagnosis,
        prepared=with_inertia(diagnosis.prepared, links),
        rungs=tuple(replace(r, fit=_fit(r.fit, joint, whole)) for r in diagnosis.rungs),
        estimated=_fit(diagnosis.estimated, joint, whole),
        open=questions,
    )


def _fit(fit: Fit, joint: str, inertia: float) -> Fit:
    return replace(fit, model=_with_inertia(fit.model, joint, inertia))


def _with_inertia(model: Model, joint: str, inertia: float) -> Model:
    name = f"{joint}.inertia"
    return model.with_values({name: replace(model.parameters[name], value=inertia)})

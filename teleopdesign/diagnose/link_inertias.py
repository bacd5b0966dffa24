"""The joints of an arm as bodies: each has the mean inertia of the links that it moves.

So structures and checks of plausibility get a body of the inertia that moves, and a joint can be
separated from its arm. The inertia of the body is subtracted from the force of the links, so
residuals do not change. Links that were misled by a missing effect have a wrong inertia first; in
the end the inertia is that of the final links.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..model import Model
from .diagnosis import Diagnosis
from .parts import PreparedParts, mean_inertias, with_inertias
from .parts_fit import PartsFit


def as_bodies(prepared: PreparedParts, first: PartsFit) -> tuple[PreparedParts, dict[str, Model]]:
    """Records and models in which each joint's body has the mean inertia of its links.

    first: the fit that the base parameters of the links are those of
    """
    links = mean_inertias(prepared, first.links)
    models = {}
    for j, fit in first.fits.items():
        motor = fit.model.parameters[f"{j}.inertia"].value
        models[j] = _with_inertia(fit.model, j, links[j] + motor)
    return with_inertias(prepared, links), models


def with_final_bodies(
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
            model = _with_inertia(model, joint, whole[joint])
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


def _with_inertia(model: Model, joint: str, inertia: float) -> Model:
    name = f"{joint}.inertia"
    return model.with_values({name: replace(model.parameters[name], value=inertia)})

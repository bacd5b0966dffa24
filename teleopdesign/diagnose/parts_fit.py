"""Parameters of all parts: those of every joint, and the base parameters that the joints share.

Each joint is fitted with the information of the other joints on the links; then the information of
this joint goes to the others. Force is linear in the base parameters and nearly linear in those of
friction, so two rounds are enough.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..base.frozen import ByValue
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate
from .error import force_error, refer_to_command
from .fit import Fit, estimate
from .link_knowledge import common_links, joint_knowledge, with_others
from .parts import PreparedParts, mean_inertias, remove_links, with_inertias
from .stated_fit import estimate_values

#: rounds over all joints of a fit: a third round changes the error by less than 1e-3
ROUNDS = 2


@dataclass(frozen=True, eq=False)
class PartsFit(ByValue):
    """All parts fitted.

    fits: joint -> its fit, with the common base parameters in `fit.model.links`
    prepared: joint -> its records, with the information of the other joints on the links
    """

    fits: Mapping[str, Fit]
    prepared: Mapping[str, Prepared]

    @property
    def links(self) -> tuple[float, ...]:
        """The common base parameters (b,)."""
        return next(iter(self.fits.values())).model.links

    @property
    def fit_errors(self) -> dict[str, float]:
        """Joint -> relative force error on the fit records."""
        return {j: f.fit_error for j, f in self.fits.items()}

    @property
    def check_errors(self) -> dict[str, float]:
        """Joint -> relative force error on the check records; NaN without such records."""
        return {j: f.check_error for j, f in self.fits.items()}

    @property
    def model(self) -> Model:
        """The model of all joints, with the common base parameters."""
        models = [fit.model for fit in self.fits.values()]
        bodies = {j: body for m in models for j, body in m.bodies.items()}
        shifts = {j: late for m in models for j, late in m.record_shift.items()}
        return Model(bodies, models[0].known, shifts).with_links(self.links)

    @property
    def fit_error(self) -> float:
        """Error of the arm on the fit records."""
        return error_over_joints(self.fit_errors)

    @property
    def check_error(self) -> float:
        """Error of the arm on the check records."""
        return error_over_joints(self.check_errors)


@dataclass(frozen=True, eq=False)
class PartsRung(ByValue):
    """One step of the ladder of all parts: the added effect with its joint, and the fit.

    added: None: the rung of the user's model
    instead_of: the effect of the user's model that the added one replaced
    other: the joint whose motion is the channel `other_position` at the effect's joint
    """

    added: Candidate | None
    fit: PartsFit
    instead_of: Candidate | None = None
    other: str | None = None

    @property
    def follows(self) -> str | None:
        """The joint whose motion the added effect depends on; None: on no other joint's."""
        if self.added is None or "other_position" not in self.added.effect.channels():
            return None
        return self.other


def error_over_joints(errors: Mapping[str, float]) -> float:
    """Root mean square of the relative errors of all joints."""
    return float(np.sqrt(np.mean(np.square(list(errors.values())))))


def estimate_parts(
    models: Mapping[str, Model],
    prepared: PreparedParts,
    *,
    rounds: int = ROUNDS,
) -> PartsFit:
    """Estimate all joints' parameters and the base parameters on the fit records.

    models: joint -> the model of that joint alone
    rounds: how often all joints are estimated
    """
    models, fits, records = dict(models), {}, dict(prepared.parts)
    for k in range(rounds):
        if prepared.base is not None:
            known, size = joint_knowledge(models, records, prepared), prepared.size
            common = common_links(known.values())
            models = {j: m.with_links(common) for j, m in models.items()}
            records = {j: with_others(p, known, size[j], models[j]) for j, p in records.items()}
        for j, model in models.items():
            start = bool(model.absent) and k == 0
            fits[j] = (estimate_values if start else estimate)(model, records[j])
            models[j] = fits[j].model
    return with_common_links(fits, records, prepared)


def as_bodies(prepared: PreparedParts, first: PartsFit) -> tuple[PreparedParts, dict[str, Model]]:
    """Records and models in which each joint's body has the mean inertia of its links.

    first: the fit that the base parameters of the links are those of
    So structures and checks of plausibility get a body of the inertia that moves, and a joint can
    be separated from its arm. This inertia is subtracted from the force of the links, so residuals
    do not change. Links that were misled by a missing effect have a wrong inertia first; in the end
    it is that of the final links (`parts_result`).
    """
    links = mean_inertias(prepared, first.links)
    models = {}
    for j, fit in first.fits.items():
        motor = fit.model.parameters[f"{j}.inertia"].value
        models[j] = with_body_inertia(fit.model, j, links[j] + motor)
    return with_inertias(prepared, links), models


def with_body_inertia(model: Model, joint: str, inertia: float) -> Model:
    """The model with another inertia (SI) of a joint's body."""
    name = f"{joint}.inertia"
    return model.with_values({name: replace(model.parameters[name], value=inertia)})


def with_common_links(
    fits: Mapping[str, Fit], records: Mapping[str, Prepared], prepared: PreparedParts
) -> PartsFit:
    """Fits of all joints, evaluated on the records with common base parameters."""
    links: tuple[float, ...] = ()
    if prepared.base is not None:
        known = joint_knowledge({j: f.model for j, f in fits.items()}, records, prepared)
        links = common_links(known.values())
    fits = {j: _evaluate_at(f, f.model.with_links(links), records[j]) for j, f in fits.items()}
    return PartsFit(fits, dict(records))


def _evaluate_at(fit: Fit, model: Model, records: Prepared) -> Fit:
    """A fit with the errors of its model at other base parameters.

    Without check records, the errors of held-out blocks are not changed.
    """
    fit = replace(fit, model=model, fit_error=force_error(model, remove_links(records.of("fit"))))
    check = records.of("check")
    if not check:
        return fit
    at_command = refer_to_command(model, check)
    return replace(fit, check_error=force_error(model, check), at_command=at_command)

"""Parameters of an arm: those of every joint, and the base parameters that all joints share.

Each joint is fitted with the information of the other joints on the links; then the information of
this joint goes to the others. Force is linear in the base parameters and nearly linear in those of
friction, so two rounds are enough.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...base.frozen import ByValue
from ...measurement.filtering import Array
from ...measurement.prepare import Prepared, Stretch
from ...measurement.shared_links import Knowledge, share, weighted_columns
from ...model import Model
from ...realise.along_motion import residual_along
from ...realise.tangent_columns import LinkParameter
from ..effort import EFFORTS, Effort
from ..error import force_error
from ..fit import Fit, block_numbers, command_error_of, estimate, free_parameters, standard_errors
from ..least_squares import column_sizes
from ..record_offsets import apply_record_offsets
from ..record_shift import record_shifts
from ..residual import relative_residuals
from ..solve import BLOCK, solve
from ..stated_fit import estimate_stated
from .prepared import PreparedArm

#: least residual, as a part of the measured force, that sets the weight of a joint: below it the
#: weight no longer grows
LEAST = 1e-4
#: rounds over all joints of a fit: a third round changes the error by less than 1e-3
ROUNDS = 2


@dataclass(frozen=True, eq=False)
class ArmFit(ByValue):
    """A fitted arm.

    fits: joint -> its fit, with the common base parameters in `fit.model.links`
    prepared: joint -> its records, with the information of the other joints on the links
    links: (b,) the common base parameters
    fit_errors, check_errors: joint -> relative force error with these; NaN without such records
    """

    fits: Mapping[str, Fit]
    prepared: Mapping[str, Prepared]
    links: tuple[float, ...]
    fit_errors: Mapping[str, float]
    check_errors: Mapping[str, float]

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


def error_over_joints(errors: Mapping[str, float]) -> float:
    """Root mean square of the relative errors of all joints."""
    return float(np.sqrt(np.mean(np.square(list(errors.values())))))


def estimate_arm(
    models: Mapping[str, Model],
    prepared: PreparedArm,
    *,
    rounds: int = ROUNDS,
    effort: Effort = EFFORTS.fine,
) -> ArmFit:
    """Estimate all joints' parameters and the base parameters on the fit records.

    models: joint -> the model of that joint alone
    rounds: how often all joints are estimated;  effort: of each estimate
    """
    models, fits, records = dict(models), {}, dict(prepared.joints)
    for k in range(rounds):
        if prepared.base is not None:
            if not any(m.absent for m in models.values()):
                models = _estimate_at_common_links(models, prepared)
            sizes = misfits(models, prepared)
            known = {j: knowledge(models[j], p.of("fit"), sizes[j]) for j, p in records.items()}
            common = _together(known)
            models = {j: m.with_links(common) for j, m in models.items()}
            records = {j: with_others(p, known, sizes[j], models[j]) for j, p in records.items()}
        for j, model in models.items():
            start = bool(model.absent) and k == 0
            fits[j] = (
                estimate_stated(model, records[j])
                if start
                else estimate(model, records[j], effort=effort)
            )
            models[j] = fits[j].model
    return with_common_links(fits, records, prepared)


def _estimate_at_common_links(
    models: Mapping[str, Model], prepared: PreparedArm
) -> dict[str, Model]:
    """Models of all joints, estimated at common base parameters that hold by the present misfits.

    A model that was misled, or has just got an effect, leaves far more than it will after its fit.
    With such a misfit its joint would have almost no weight in the base parameters.
    """
    sizes = misfits(models, prepared)
    known = {j: knowledge(models[j], p.of("fit"), sizes[j]) for j, p in prepared.joints.items()}
    common = _together(known)
    there = {}
    for j, records in prepared.joints.items():
        plain = replace(records, stretches=remove_links(records.of("fit")))
        model, free = models[j].with_links(common), free_parameters(models[j])
        there[j] = solve(model, free, plain, plain.stretches, EFFORTS.rough).model
    return there


def with_common_links(
    fits: Mapping[str, Fit], records: Mapping[str, Prepared], prepared: PreparedArm
) -> ArmFit:
    """Fits of all joints, evaluated on the records with common base parameters."""
    links: tuple[float, ...] = ()
    if prepared.base is not None:
        sizes = misfits({j: f.model for j, f in fits.items()}, prepared)
        known = {j: knowledge(f.model, records[j].of("fit"), sizes[j]) for j, f in fits.items()}
        links = _together(known)
    fits = {j: _evaluate_at(f, f.model.with_links(links), records[j]) for j, f in fits.items()}
    return ArmFit(
        fits=fits,
        prepared=dict(records),
        links=links,
        fit_errors={j: f.fit_error for j, f in fits.items()},
        check_errors={j: f.check_error for j, f in fits.items()},
    )


def _evaluate_at(fit: Fit, model: Model, records: Prepared) -> Fit:
    """A fit with the errors of its model at other base parameters.

    Without check records, the errors of held-out blocks are not changed.
    """
    fit = replace(fit, model=model, fit_error=force_error(model, remove_links(records.of("fit"))))
    check = records.of("check")
    if not check:
        return fit
    at_command = command_error_of(model, check)
    return replace(fit, check_error=force_error(model, check), at_command=at_command)


def misfits(models: Mapping[str, Model], prepared: PreparedArm) -> dict[str, float]:
    """Joint -> root of the squares that its model leaves: the scale of its observations.

    So a joint that lacks an effect has little weight in the links, which all joints depend on.
    While an effect has no start value yet, the scale is the root of the measured squares.
    """
    if any(m.absent for m in models.values()):
        return dict(prepared.size)
    left = {
        j: force_error(m, remove_links(prepared.joints[j].of("fit"))) for j, m in models.items()
    }
    return {j: max(left[j], LEAST) * size for j, size in prepared.size.items()}


def add_links(model: Model, stretches: tuple[Stretch, ...]) -> tuple[Stretch, ...]:
    """Stretches with the force of the links at a joint; at rest, friction balances this force.

    Otherwise rows at rest would confirm the base parameters of the model.
    """
    made = []
    for s, (body, motion) in zip(stretches, apply_record_offsets(model, stretches), strict=True):
        assert s.motion.links is not None
        wrt = [LinkParameter(motion.body, k) for k in range(len(model.links))]
        slopes = residual_along(body, motion, wrt).residual.tangent
        links = replace(s.motion.links, smooth=-s.motion.lowpassed(slopes))
        made.append(replace(s, motion=replace(s.motion, links=links)))
    return tuple(made)


def remove_links(stretches: tuple[Stretch, ...]) -> tuple[Stretch, ...]:
    """Stretches as they were measured, without reduced weight in the directions of the links."""
    return tuple(replace(s, shared=None) for s in stretches)


def knowledge(model: Model, stretches: tuple[Stretch, ...], size: float) -> Knowledge:
    """Information of one joint on the base parameters, when its other parameters are free.

    size: root of the squares that count as one observation
    """
    columns, residual, slopes, _ = _linear(model, stretches, is_held=True)
    basis = _basis(slopes)
    columns, residual = (x - basis @ (basis.T @ x) for x in (columns, residual))
    # residual at b: residual - columns (b - links)
    target = residual + columns @ np.asarray(model.links)
    return Knowledge(columns.T @ columns / size**2, columns.T @ target / size**2)


def _linear(
    model: Model, stretches: tuple[Stretch, ...], *, is_held: bool = False
) -> tuple[Array, Array, Array, tuple[Stretch, ...]]:
    """Linear problem of a joint, with the priors of its shifts as additional rows.

    is_held: whether shifts that are held, or at a bound, cannot change: else the links would be
        those of a shift that the joint does not have
    returns: columns of the links (rows, b), residual (rows,), columns of the joint's parameters and
        shifts, and the stretches
    """
    plain, free = remove_links(add_links(model, stretches)), _list_inner_parameters(model)
    lasts = sum(s.counted_time for s in plain)
    shifts = record_shifts(plain, round(lasts / BLOCK), model)
    parts = relative_residuals(model, plain, (*free, *shifts.names))
    roots = [np.sqrt(s.weight) for s in plain]
    residual = np.concatenate([w * r for w, (r, _) in zip(roots, parts, strict=True)])
    slopes = np.concatenate([w * d.T for w, (_, d) in zip(roots, parts, strict=True)])
    slopes = slopes * np.append(np.ones(len(free)), shifts.row)
    samples = shifts.start(model)
    known, slope = shifts.prior(samples, residual, slopes)
    if is_held:
        stays = shifts.held | shifts.at_bound(samples)
        for part in (slopes, slope):
            part[:, len(free) :][:, stays] = 0.0
    columns = np.vstack([weighted_columns(s) for s in plain])
    nothing = np.zeros((len(known), columns.shape[1]))
    return (
        np.vstack([columns, nothing]),
        np.append(residual, known),
        np.vstack([slopes, slope]),
        plain,
    )


def _list_inner_parameters(model: Model) -> tuple[str, ...]:
    """Free parameters of present effects, and the strengths of absent effects."""
    absent = {f"{at}.{name}" for name, at in model.absent}
    first = {f"{at}.{n}.{model.body(at).effect(n).strength}" for n, at in model.absent}
    free = free_parameters(model)
    return tuple(n for n in free if n.rpartition(".")[0] not in absent or n in first)


def _basis(columns: Array) -> Array:
    """Orthonormal basis of the span of the columns."""
    size = column_sizes(columns)
    columns = columns[:, size > 0] / size[size > 0]
    basis, s, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(basis[:, s > 1e-8 * s.max(initial=0.0)])


def _together(known: Mapping[str, Knowledge]) -> tuple[float, ...]:
    whole = _sum(list(known.values()))
    return tuple(float(x) for x in whole.best())


def _sum(known: list[Knowledge]) -> Knowledge:
    whole = known[0]
    for one in known[1:]:
        whole = whole + one
    return whole


def with_others(
    prepared: Prepared, known: Mapping[str, Knowledge], size: float, model: Model
) -> Prepared:
    """Records of a joint with the information of the other joints on the links.

    known: joint -> its information;  size: scale of this joint's observations;  model: of this
        joint
    """
    (joint,) = model.bodies
    mine = known[joint]
    nothing = Knowledge(np.zeros_like(mine.matrix), np.zeros_like(mine.vector))
    others = _sum([nothing, *(k for j, k in known.items() if j != joint)])
    fit = iter(share(add_links(model, prepared.of("fit")), others, size))
    stretches = tuple(next(fit) if s.use == "fit" else s for s in prepared.stretches)
    return replace(prepared, stretches=stretches)


def link_errors(arm: ArmFit, prepared: PreparedArm) -> Array:
    """Standard errors (b,) of the base parameters; NaN where no residual depends on one."""
    sizes = misfits({j: f.model for j, f in arm.fits.items()}, prepared)
    rows, left, blocks, first = [], [], [], 0
    for j, fit in arm.fits.items():
        columns, residual, slopes, plain = _linear(fit.model, arm.prepared[j].of("fit"))
        basis, n = _basis(slopes), len(residual)
        numbers = block_numbers(plain)
        numbers = np.append(numbers, np.full(n - len(numbers), numbers.max() + 1))
        rows.append((columns - basis @ (basis.T @ columns)) / sizes[j])
        left.append((residual - basis @ (basis.T @ residual)) / sizes[j])
        blocks.append(numbers + first)
        first = int(blocks[-1].max()) + 1
    return standard_errors(np.vstack(rows), np.concatenate(left), np.concatenate(blocks))

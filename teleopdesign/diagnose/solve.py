"""The search for parameters: bounded least squares on the low-passed residual force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from ..measurement.record_clock import CLOCK
from ..measurement.shared_links import best_links
from ..model import Model
from .bodies_apart import BodyByBody
from .least_squares import gauss_newton_step, minimise, sum_of_squares
from .record_shift import RecordShifts, record_shifts
from .residual import residuals
from .search_plan import Effort

#: seconds over which residuals count as one observation in standard errors and tests
BLOCK = 0.25
#: distance to a bound, in the scale of the record, within which a parameter counts as at the bound
AT_BOUND = 1e-6
#: search range of a logarithmic parameter: decades to either side of the scale of the record
DECADES = 8.0


@dataclass(frozen=True)
class Solution:
    """Free parameters at the optimum, with weighted residual and Jacobian by value / scale.

    model: with these values, and the shifts of the records
    values, scale, at_bound: (p,);  residual: (rows,);  jacobian: (rows, p)
    by_shift: (rows, k) derivative of the residual by the k `shifts`, in rows of a record
    shift_at_bound: (k,)
    """

    model: Model
    values: Array
    scale: Array
    at_bound: NDArray[np.bool_]
    residual: Array
    jacobian: Array
    shifts: RecordShifts
    by_shift: Array
    shift_at_bound: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class _SearchSpace:
    """Search coordinates x (p,) of the free parameters: value over scale, or its logarithm.

    scale: (p,) SI value of the unit of each;  decades: (p,) whether x is a logarithm
    lower, upper, start: (p,) bounds of x, and where the search starts
    limited: (p,) whether the upper bound is a `FitSearch.limit`, no bound of the parameter
    """

    scale: Array
    decades: NDArray[np.bool_]
    lower: Array
    upper: Array
    start: Array
    limited: NDArray[np.bool_]

    def values(self, x: Array) -> Array:
        """Values (p,) of the parameters at x, in SI units."""
        return self.scale * np.where(self.decades, np.exp(np.where(self.decades, x, 0.0)), x)

    def units(self, x: Array) -> Array:
        """Derivatives (p,) of the values by x, in SI units."""
        return np.where(self.decades, self.values(x), self.scale)


def _search_space(model: Model, free: tuple[str, ...], prepared: Prepared) -> _SearchSpace:
    """Search coordinates of the free parameters, with scales of the fit records."""
    unit = prepared.scales
    declared = [model.declared(n) for n in free]
    scale = np.array([unit[d.scale] for d in declared])
    decades = np.array([spans_decades(model, n) for n in free], dtype=bool)
    lower = np.array([d.lower for d in declared]) / scale
    upper = np.array(
        [min(d.upper / s, d.search.within) for d, s in zip(declared, scale, strict=True)]
    )
    limits = np.array([d.search.limit for d in declared])
    limited, upper = limits < upper, np.minimum(limits, upper)
    start = np.array([model.parameters[n].value for n in free]) / scale
    lower[decades] = -DECADES * np.log(10)
    upper[decades] = np.log(np.minimum(upper[decades], 10.0**DECADES))
    start[decades] = np.log(np.maximum(start[decades], 1e-300))
    # slightly inside the bounds: a law may divide by a parameter whose bound is zero
    inside = lower + 0.1 * AT_BOUND, upper - 0.1 * AT_BOUND
    return _SearchSpace(scale, decades, *inside, start, limited)


@dataclass(frozen=True, eq=False)
class SearchResiduals:
    """Residual and Jacobian at search coordinates x (p + k,): free parameters, then k shifts."""

    model: Model
    free: tuple[str, ...]
    space: _SearchSpace
    shifts: RecordShifts
    bodies: BodyByBody

    def model_at(self, x: Array) -> Model:
        """The model with the parameters and shifts at x."""
        values = self.space.values(x[: len(self.free)]).tolist()
        moved = self.model.with_values(dict(zip(self.free, values, strict=True)))
        return self.shifts.beside(moved, x[len(self.free) :])

    def _units(self, x: Array) -> Array:
        return np.append(self.space.units(x[: len(self.free)]), self.shifts.row)

    def both(self, x: Array) -> tuple[Array, Array]:
        """Residual (rows,) and Jacobian (rows, p + k)."""
        return self.bodies.both(self.model_at(x), x, self._units(x))

    def with_prior(self, x: Array) -> tuple[Array, Array]:
        """The same, with the k rows of the prior of the shifts; none changes by a held shift."""
        return self.add_prior(x, *self.both(x))

    def add_prior(self, x: Array, residual: Array, jacobian: Array) -> tuple[Array, Array]:
        """A residual and its Jacobian at x, with the rows of the prior as in `with_prior`."""
        p, shifts = len(self.free), self.shifts
        known, slope = shifts.prior(x[p:], residual, jacobian)
        both = np.vstack([jacobian, slope])
        both[:, p:][:, shifts.held] = 0.0
        return np.append(residual, known), both

    def residual_with_prior(self, x: Array) -> Array:
        """The residual of `with_prior` alone."""
        r = self.bodies.residual(self.model_at(x), x, self._units(x))
        return np.append(r, self.shifts.prior_alone(x[len(self.free) :], r))


def solve(
    model: Model,
    free: tuple[str, ...],
    prepared: Prepared,
    stretches: Sequence[Stretch],
    effort: Effort,
) -> Solution:
    """Bounded least squares on the relative residuals of these stretches, by shifts as well."""
    left, start, lower, upper = search_problem(model, free, prepared, stretches, effort)
    space, shifts, p = left.space, left.shifts, len(free)
    if len(start):
        minimum = minimise(
            left.with_prior,
            start,
            lower,
            upper,
            tolerance=effort.tolerance,
            evaluations=effort.evaluations,
            residual_alone=left.residual_with_prior,
        )
        best, rows = minimum.values, len(minimum.residual) - len(shifts.logs)
        residual, jacobian = minimum.residual[:rows], minimum.jacobian[:rows]
    else:
        best, (residual, jacobian) = start, left.both(start)
    if any(s.shared is not None for s in stretches):
        left = replace(left, model=settle_links(left.model_at(best), stretches))
        residual, jacobian = left.both(best)
    at_upper = upper - best < AT_BOUND
    at_upper[:p] &= ~space.limited
    at_bound = (best - lower < AT_BOUND) | at_upper
    return Solution(
        model=left.model_at(best),
        values=space.values(best[:p]),
        scale=space.units(best[:p]),
        at_bound=at_bound[:p],
        residual=residual,
        jacobian=jacobian[:, :p],
        shifts=shifts,
        by_shift=jacobian[:, p:],
        shift_at_bound=at_bound[p:],
    )


def search_problem(
    model: Model,
    free: tuple[str, ...],
    prepared: Prepared,
    stretches: Sequence[Stretch],
    effort: Effort,
) -> tuple[SearchResiduals, Array, Array, Array]:
    """Residuals of a search on these stretches, its start and its bounds, (p + k,) each."""
    space = _search_space(model, free, prepared)
    lasts = sum(s.weight * len(s.keep) * s.row for s in stretches)
    shifts = record_shifts(stretches, round(lasts / BLOCK), model)
    lower = np.append(space.lower, np.full(len(shifts.logs), -CLOCK.early))
    upper = np.append(space.upper, shifts.latest)
    start = np.append(space.start, shifts.start(model))
    bodies = BodyByBody(model, (*free, *shifts.names), stretches, tolerance=effort.tolerance)
    return SearchResiduals(model, free, space, shifts, bodies), start, lower, upper


def model_without(
    solution: Solution,
    free: tuple[str, ...],
    prepared: Prepared,
    known: Sequence[Stretch],
    rows: NDArray[np.bool_],
    effort: Effort,
) -> Model:
    """The model of a solution, estimated on some of its rows alone.

    One step by the derivatives of the solution leads there, if the residual is as linear as the
    effort resolves; if not, the search goes on.

    known: the stretches with these rows;  rows: which of the solution's rows these are
    """
    left, start, lower, upper = search_problem(solution.model, free, prepared, known, effort)
    if any(s.shared is not None for s in known) or not len(start):
        return solve(solution.model, free, prepared, known, effort).model
    columns = np.hstack([solution.jacobian, solution.by_shift])[rows]
    r, j = left.add_prior(start, solution.residual[rows], columns)
    x = np.clip(start, lower, upper)
    step = gauss_newton_step(j, r, lower - x, upper - x)
    if not np.isfinite(step).all():
        return solution.model
    there = np.clip(x + step, lower, upper)
    promised = sum_of_squares(r + j @ (there - x))
    reached = sum_of_squares(left.residual_with_prior(there))
    near = left.model_at(there) if reached < sum_of_squares(r) else solution.model
    if reached <= (1.0 + effort.tolerance) * promised:
        return near
    return solve(near, free, prepared, known, effort).model


def settle_links(model: Model, stretches: Sequence[Stretch]) -> Model:
    """The model with the best base parameters of its arm, all other parameters held."""
    left = [r for r, _ in residuals(model, stretches)]
    return model.with_links(best_links(model.links, stretches, left))


def spans_decades(model: Model, name: str) -> bool:
    """Whether a parameter is searched on a logarithmic scale.

    So is a parameter of an effect that is not negative and has no upper bound, except a strength
    that may be zero: its scale is linear, so that it can reach zero.
    """
    declared = model.declared(name)
    place, local_name = model.locate(name)
    effect, _, parameter = local_name.partition(".")
    if not parameter or declared.lower < 0 or np.isfinite(declared.upper):
        return False
    return model.body(place).effect(effect).absent.get(parameter) != 0.0

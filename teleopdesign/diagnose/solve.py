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
from .criteria import CRITERIA
from .least_squares import minimise, sum_of_squares
from .record_shift import RecordShifts, record_shifts
from .residual import residuals, weighted_residuals
from .search_plan import Effort

#: seconds over which residuals count as one observation in standard errors and tests
BLOCK = 0.25
#: distance to a bound, in the scale of the record, within which a parameter counts as at the bound
AT_BOUND = 1e-6
#: search range of a logarithmic parameter: decades to either side of the scale of the record
DECADES = 8.0


def free_parameters(model: Model) -> tuple[str, ...]:
    """Names of the parameters that are not fixed."""
    return tuple(n for n, v in model.parameters.items() if not v.fixed)


@dataclass(frozen=True, eq=False)
class Solution:
    """A model at the optimum, with weighted residual and Jacobian by value / scale.

    free: its p free parameters;  shifts: the k shifts of the records
    scale, at_bound: (p + k,), the parameters first;  residual: (rows,);  jacobian: (rows, p + k)
    """

    model: Model
    free: tuple[str, ...]
    shifts: RecordShifts
    scale: Array
    at_bound: NDArray[np.bool_]
    residual: Array
    jacobian: Array

    @property
    def by_shift(self) -> Array:
        """Derivatives of the residual by the shifts that are at no bound, in rows of a record."""
        p = len(self.free)
        return self.jacobian[:, p:][:, ~self.at_bound[p:]]


@dataclass(frozen=True, eq=False)
class SearchProblem:
    """The residual of a model over search coordinates x (p + k,), with the prior of its shifts.

    A coordinate is the value of one of p free parameters over its scale, or the logarithm of that;
    the last k are shifts, in rows of a record.
    scale: (p + k,) SI value of the unit of each;  decades: whether x is a logarithm
    lower, upper, start: (p + k,) bounds of x, and where the search starts
    limited: (p + k,) whether the upper bound is a `FitSearch.limit`, no bound of the parameter
    """

    model: Model
    free: tuple[str, ...]
    shifts: RecordShifts
    stretches: Sequence[Stretch]
    scale: Array
    decades: NDArray[np.bool_]
    lower: Array
    upper: Array
    start: Array
    limited: NDArray[np.bool_]

    def values(self, x: Array) -> Array:
        """Values (p + k,) of parameters and shifts at x, in SI units."""
        return self.scale * np.where(self.decades, np.exp(np.where(self.decades, x, 0.0)), x)

    def units(self, x: Array) -> Array:
        """Derivatives (p + k,) of the values by x, in SI units."""
        return np.where(self.decades, self.values(x), self.scale)

    def model_at(self, x: Array) -> Model:
        """The model with the parameters and shifts at x."""
        values = self.values(x)[: len(self.free)].tolist()
        moved = self.model.with_values(dict(zip(self.free, values, strict=True)))
        return self.shifts.beside(moved, x[len(self.free) :])

    def both(self, x: Array) -> tuple[Array, Array]:
        """Residual (rows,) and Jacobian (rows, p + k), without the prior."""
        names = (*self.free, *self.shifts.names)
        residual, columns = weighted_residuals(self.model_at(x), self.stretches, names)
        return residual, columns * self.units(x)

    def with_prior(self, x: Array) -> tuple[Array, Array]:
        """The same, with the k rows of the prior of the shifts; none changes by a held shift."""
        p, shifts = len(self.free), self.shifts
        residual, jacobian = self.both(x)
        known, slope = shifts.prior(x[p:], residual, jacobian)
        both = np.vstack([jacobian, slope])
        both[:, p:][:, shifts.held] = 0.0
        return np.append(residual, known), both

    def residual_with_prior(self, x: Array) -> Array:
        """The residual of `with_prior` alone."""
        r, _ = weighted_residuals(self.model_at(x), self.stretches)
        return np.append(r, self.shifts.prior_alone(x[len(self.free) :], r))


def search_problem(
    model: Model, prepared: Prepared, stretches: Sequence[Stretch] | None = None
) -> SearchProblem:
    """The search for the free parameters of a model on some stretches; None: the fit records.

    prepared: the records, whose motion gives the scales
    """
    stretches = prepared.of("fit") if stretches is None else stretches
    free, unit = free_parameters(model), prepared.scales
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
    lasts = sum(s.weight * len(s.keep) * s.row for s in stretches)
    shifts = record_shifts(stretches, round(lasts / BLOCK), model)
    none = np.zeros(len(shifts.logs), dtype=bool)
    # slightly inside the bounds: a law may divide by a parameter whose bound is zero
    return SearchProblem(
        model,
        free,
        shifts,
        stretches,
        scale=np.append(scale, shifts.row),
        decades=np.append(decades, none),
        lower=np.append(lower + 0.1 * AT_BOUND, np.full(len(none), -CLOCK.early)),
        upper=np.append(upper - 0.1 * AT_BOUND, shifts.latest),
        start=np.append(start, shifts.start(model)),
        limited=np.append(limited, none),
    )


def solve(
    model: Model, prepared: Prepared, effort: Effort, stretches: Sequence[Stretch] | None = None
) -> Solution:
    """Bounded least squares on the relative residuals of these stretches, by shifts as well.

    stretches: None: the fit records
    """
    stretches = prepared.of("fit") if stretches is None else stretches
    problem = search_problem(model, prepared, stretches)
    best, residual, jacobian = _minimum(problem, effort)
    while any(s.shared is not None for s in stretches):
        before = sum_of_squares(residual)
        model = settle_links(problem.model_at(best), stretches)
        problem = replace(problem, model=model, start=best)
        residual, jacobian = problem.both(best)
        # other rows may rest with other links: the search goes on while these links leave less
        if not sum_of_squares(residual) < (1.0 - CRITERIA.relative_improvement) * before:
            break
        best, residual, jacobian = _minimum(problem, effort)
    at_upper = (problem.upper - best < AT_BOUND) & ~problem.limited
    return Solution(
        model=problem.model_at(best),
        free=problem.free,
        shifts=problem.shifts,
        scale=problem.units(best),
        at_bound=(best - problem.lower < AT_BOUND) | at_upper,
        residual=residual,
        jacobian=jacobian,
    )


def _minimum(problem: SearchProblem, effort: Effort) -> tuple[Array, Array, Array]:
    """Coordinates (p + k,) of the minimum, residual (rows,) and Jacobian (rows, p + k) there."""
    if not len(problem.start):
        return problem.start, *problem.both(problem.start)
    minimum = minimise(
        problem.with_prior,
        problem.start,
        problem.lower,
        problem.upper,
        tolerance=effort.tolerance,
        evaluations=effort.evaluations,
        residual_alone=problem.residual_with_prior,
    )
    rows = len(minimum.residual) - len(problem.shifts.logs)
    return minimum.values, minimum.residual[:rows], minimum.jacobian[:rows]


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

"""A fitted model: parameters with standard errors, and errors on fit and check records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..base.frozen import ByValue
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from ..model import Model
from .error import AtCommand, force_error, refer_to_command
from .folds import folds
from .least_squares import column_sizes, sum_of_squares
from .residual import weighted_residuals
from .search_plan import EFFORTS, Effort
from .solve import BLOCK, Solution, solve


@dataclass(frozen=True, eq=False, repr=False)
class Fit(ByValue):
    """A fitted model: parameters with standard errors, and errors on fit and check records.

    free: names of the p estimated parameters;  at_bound: those that end at a bound
    fit_error, check_error: relative force errors; NaN where there is no such record
    fit_residual, check_residual: low-passed residuals on the rows that count, weighted, relative to
        the force that acts in the model (`relative_residuals`); used to compare models
    at_command: residual on the check records as an error of the recorded forces: an effect must
        lower it too
    fit_blocks, check_blocks: block number of each row of these residuals
    jacobian: (rows, p) derivative of fit_residual by `free`, in units of `scale`
    scale: (p,) SI value of the unit of each free parameter in `jacobian`
    by_shift: (rows, k) derivative of fit_residual by the k shifts of records that are at no bound
    """

    model: Model
    free: tuple[str, ...]
    fit_error: float
    check_error: float
    at_bound: tuple[str, ...]
    fit_residual: Array
    check_residual: Array
    at_command: AtCommand
    fit_blocks: NDArray[np.intp]
    check_blocks: NDArray[np.intp]
    jacobian: Array
    scale: Array
    by_shift: Array

    @property
    def check_error_at_command(self) -> float:
        """The check error as one of the recorded command; NaN: all is blind."""
        return self.at_command.error

    @property
    def blind(self) -> float:
        """Share of the sliding samples in which the command has no influence."""
        return self.at_command.blind

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlation of each pair of estimates that the records move, the largest first."""
        covariance, _, sensitive = sandwich(self.jacobian, self.fit_residual, self.fit_blocks)
        moving = np.flatnonzero(sensitive)
        spread = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        correlation = covariance / np.outer(spread, spread)
        pairs = {
            (self.free[moving[i]], self.free[moving[j]]): float(correlation[i, j])
            for i in range(len(moving))
            for j in range(i)
        }
        return dict(sorted(pairs.items(), key=lambda one: (-abs(one[1]), one[0])))

    def __repr__(self) -> str:
        return (
            f"Fit of {len(self.free)} parameters: fit error {100 * self.fit_error:.2f} %, check "
            f"error {100 * self.check_error:.2f} %"
        )


def fit_squares(fit: Fit) -> float:
    """Sum of squares on the fit records, relative to the force that acts in the model.

    inf: the motion of the model grows beyond all numbers
    """
    return sum_of_squares(fit.fit_residual)


def block_numbers(stretches: Sequence[Stretch]) -> NDArray[np.intp]:
    """Block number of each row; a block is a quarter of a second of one stretch."""
    parts, first = [], 0
    for s in stretches:
        numbers = ((s.motion.time[s.keep] - s.motion.time[s.keep[0]]) / BLOCK).astype(int)
        parts.append(numbers + first)
        first += int(numbers[-1]) + 1
    return np.concatenate(parts) if parts else np.zeros(0, dtype=int)


def estimate(model: Model, prepared: Prepared, *, effort: Effort = EFFORTS.fine) -> Fit:
    """Re-estimate the parameters of the model that are not fixed, on the fit records.

    Without check records, blocks of the fit records are held out in turn. The check error then
    comes from fits without those blocks.
    """
    return fit_of(solve(model, prepared, effort), prepared)


def fit_of(solution: Solution, prepared: Prepared) -> Fit:
    """The fit of a solution on the fit records, with its errors on both uses."""
    stretches, free, p = prepared.of("fit"), solution.free, len(solution.free)
    blocks = block_numbers(stretches)
    fitted = with_errors(_with_held_shifts(solution, stretches), blocks).canonical()
    check = prepared.of("check")
    if check:
        check_error, check_residual, command_error = _errors_on(fitted, check)
    else:
        check, check_residual, check_error, command_error = _fit_held_out(solution, prepared)
    return Fit(
        model=fitted,
        free=free,
        fit_error=force_error(fitted, stretches),
        check_error=check_error,
        at_bound=tuple(n for n, b in zip(free, solution.at_bound[:p], strict=True) if b),
        fit_residual=solution.residual,
        check_residual=check_residual,
        at_command=command_error,
        fit_blocks=blocks,
        check_blocks=block_numbers(check),
        jacobian=solution.jacobian[:, :p],
        scale=solution.scale[:p],
        by_shift=solution.by_shift,
    )


def _errors_on(model: Model, stretches: Sequence[Stretch]) -> tuple[float, Array, AtCommand]:
    """Force error, weighted relative residual and the error at the command of a model."""
    relative, _ = weighted_residuals(model, stretches)
    return force_error(model, stretches), relative, refer_to_command(model, stretches)


def _with_held_shifts(solution: Solution, stretches: Sequence[Stretch]) -> Solution:
    """The solution with derivatives by the shifts that the search held, too.

    A search holds these shifts and computes no derivatives by them. The standard errors of the
    parameters must include their uncertainty.
    """
    shifts = solution.shifts
    if not shifts.held.any():
        return solution
    _, by_shift = weighted_residuals(solution.model, stretches, shifts.names)
    by_parameter = solution.jacobian[:, : len(solution.free)]
    return replace(solution, jacobian=np.hstack([by_parameter, by_shift * shifts.row]))


def with_errors(solution: Solution, blocks: NDArray[np.intp]) -> Model:
    """The model of a solution, with standard errors of all that was estimated.

    A shift at its bound counts as certain: it adds nothing to the other standard errors.
    """
    shifts, model, p = solution.shifts, solution.model, len(solution.free)
    by_shift = np.where(solution.at_bound[p:], 0.0, solution.jacobian[:, p:])
    jacobian = np.hstack([solution.jacobian[:, :p], by_shift])
    errors = standard_errors(*shifts.observed(solution.residual, jacobian, blocks))
    parameter_errors = errors[:p] * solution.scale[:p]
    values = {
        n: replace(model.parameters[n], stderr=float(e))
        for n, e in zip(solution.free, parameter_errors, strict=True)
    }
    model = model.with_values(values)
    return shifts.beside(model, shifts.start(model), errors[p:])


def _fit_held_out(
    solution: Solution, prepared: Prepared
) -> tuple[tuple[Stretch, ...], Array, float, AtCommand]:
    """Weighted residual and errors of blocks of the fit records, each from a fit without it."""
    held: list[Stretch] = []
    parts: list[Array] = []
    command_errors: list[AtCommand] = []
    squares = at_commands = 0.0
    stretches = prepared.of("fit")
    for fold in folds(stretches):
        model = solve(solution.model, prepared, EFFORTS.held_out, fold.known).model
        error, relative, at_command = _errors_on(model, fold.held_out)
        held += fold.held_out
        parts.append(relative)
        command_errors.append(at_command)
        measured = sum(s.measured for s in fold.held_out)
        squares += error**2 * measured
        at_commands += command_errors[-1].error ** 2 * measured
    whole = sum(s.measured for s in held)
    together = AtCommand(
        np.concatenate([one.residual for one in command_errors]),
        np.concatenate([one.sighted for one in command_errors]),
        float(np.sqrt(at_commands / whole)),
        float(np.mean([one.blind for one in command_errors])),
    )
    return tuple(held), np.concatenate(parts), float(np.sqrt(squares / whole)), together


def standard_errors(jacobian: Array, residual: Array, blocks: NDArray[np.intp]) -> Array:
    """Standard errors that hold for residuals correlated within a block (sandwich estimate).

    jacobian: (rows, p);  residual: (rows,);  blocks: (rows,) block number of each row
    returns: (p,) standard errors; NaN where the residual does not depend on the parameter, and for
        all parameters where a search diverged until numbers overflow
    """
    covariance, norm, sensitive = sandwich(jacobian, residual, blocks)
    errors = np.full(jacobian.shape[1], np.nan)
    errors[sensitive] = np.sqrt(np.maximum(np.diag(covariance), 0.0)) / norm
    return errors


def sandwich(
    jacobian: Array, residual: Array, blocks: NDArray[np.intp]
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """The sandwich estimate for columns of size one, these sizes, and which of the p have any.

    Where a search diverged until numbers overflow, none has.
    """
    p = jacobian.shape[1]
    norm = column_sizes(jacobian) if p else np.zeros(0)
    sensitive = norm > 0
    if not p or not (np.isfinite(norm).all() and np.isfinite(residual).all()):
        return np.zeros((0, 0)), np.zeros(0), np.zeros(p, dtype=bool)
    scaled = jacobian[:, sensitive] / norm[sensitive]
    bread = np.linalg.pinv(scaled.T @ scaled, rcond=1e-12, hermitian=True)
    scores = np.zeros((int(blocks.max()) + 1, int(sensitive.sum())))
    np.add.at(scores, blocks, scaled * residual[:, None])
    count = len(scores)
    meat = scores.T @ scores * count / max(count - p, 1)
    return bread @ meat @ bread, norm[sensitive], sensitive

"""Bounded nonlinear least squares by damped Gauss-Newton steps.

scipy's trust-region method approaches a bound slowly through the interior, and most candidates of a
diagnosis end at one (an effect that is absent). Here each step is a bounded linear problem with one
unknown per parameter, solved by scipy's `lsq_linear`: a bound is reached at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import orth
from scipy.linalg.lapack import dgeqrf
from scipy.optimize import lsq_linear

from ..measurement.filtering import Array
from .cores import one_thread_of_algebra

#: smallest damping of a step, of the size of the columns: proportional columns share their step
LEAST_DAMPING = 1e-12
#: a column of this size has no square
_ROOT_OF_LARGEST = math.sqrt(np.finfo(float).max)


@dataclass(frozen=True)
class Minimum:
    """Parameters (p,) with the least sum of squares; residual (n,) and Jacobian (n, p) there."""

    values: Array
    residual: Array
    jacobian: Array


@one_thread_of_algebra()
def minimise(
    function: Callable[[Array], tuple[Array, Array]],
    start: Array,
    lower: Array,
    upper: Array,
    *,
    tolerance: float,
    evaluations: int,
    residual_alone: Callable[[Array], Array] | None = None,
) -> Minimum:
    """Parameters that minimise the sum of squares of the residual, within bounds.

    function: x (p,) -> residual (n,), Jacobian (n, p)
    residual_alone: the same residual where no Jacobian is needed; None: it takes as long
    start, lower, upper: (p,)
    tolerance: relative change of squares at which the search ends; after a step without such a
        change, the next one must promise it
    evaluations: most calls of the function
    """
    x = np.clip(start, lower, upper)
    residual, jacobian = function(x)
    squares, damping, quiet, failed = sum_of_squares(residual), 1e-3, 0, False
    for _ in range(evaluations - 1):
        step = gauss_newton_step(jacobian, residual, lower - x, upper - x, damping)
        if not np.isfinite(step).all():
            break
        trial = np.clip(x + step, lower, upper)
        expected = squares - float(np.sum((residual + jacobian @ (trial - x)) ** 2))
        # after a step that gained less than the tolerance, or failed, tangents promise too much
        least = tolerance if quiet or failed else 1e-3 * tolerance
        if expected <= least * squares:
            break
        # a step after one that failed mostly fails too, and its Jacobian would serve nothing
        if failed and residual_alone is not None:
            failed = not sum_of_squares(residual_alone(trial)) < squares
        else:
            failed = False
        if not failed:
            new_residual, new_jacobian = function(trial)
            failed = not sum_of_squares(new_residual) < squares
        if failed:
            damping *= 10.0
            if damping > 1e8:
                break
            continue
        new = sum_of_squares(new_residual)
        good = (squares - new) / expected
        damping = damping / 10.0 if good > 0.75 else damping * 3.0 if good < 0.25 else damping
        quiet = quiet + 1 if squares - new < tolerance * squares else 0
        x, residual, jacobian, squares = trial, new_residual, new_jacobian, new
        if quiet >= 2:
            break
    return Minimum(np.asarray(x), residual, jacobian)


def sum_of_squares(residual: Array) -> float:
    """Sum of squares of a residual (n,); inf where a motion grows beyond all numbers."""
    with np.errstate(over="ignore", invalid="ignore"):
        squares = float(residual @ residual)
    return squares if math.isfinite(squares) else math.inf


def column_sizes(columns: Array) -> Array:
    """Euclidean norms (p,) of columns (n, p); inf where squares overflow."""
    with np.errstate(over="ignore"):
        return np.asarray(np.linalg.norm(columns, axis=0))


def span(columns: Array) -> Array:
    """Orthonormal columns (n, r) that span columns (n, p), of which r are independent."""
    size = column_sizes(columns)
    kept = (size > 0.0) & np.isfinite(size)
    return np.asarray(orth(columns[:, kept] / size[kept], rcond=1e-8))


def reduce_to_triangle(columns: Array, residual: Array) -> tuple[Array, Array, Array]:
    """Sizes (p,) of columns (n, p), and the least-squares problem reduced to p rows.

    With columns of size 1, |columns x + residual| = |triangle x + target| but for a constant. The
    triangle comes from an orthogonal factorisation: it has the condition of the columns, their
    products would have its square.

    sizes: Euclidean norms, 1 for a column of zeros; inf where squares are no numbers
    returns: sizes, triangle (p, p), target (p,)
    """
    p = columns.shape[1]
    beside = np.zeros((max(len(residual), p + 1), p + 1), order="F")
    peak = np.max(np.abs(columns), axis=0, initial=0.0)
    peak[peak == 0.0] = 1.0
    if not (peak < _ROOT_OF_LARGEST).all() or not np.isfinite(residual).all():
        return np.full(p, np.inf), np.zeros((p, p)), np.zeros(p)
    beside[: len(residual), :p] = columns / peak
    beside[: len(residual), p] = residual
    factor = dgeqrf(beside, overwrite_a=True)[0][:p]
    triangle = np.triu(factor[:, :p])
    size = column_sizes(triangle)
    size[size == 0.0] = 1.0
    return size * peak, triangle / size, factor[:, p]


def add_damping(triangle: Array, target: Array, damping: float) -> tuple[Array, Array]:
    """Rows (2 p, p) and right-hand side (2 p,) of |triangle x + target|^2 + damping |x|^2."""
    p = len(target)
    return np.vstack([triangle, np.sqrt(damping) * np.eye(p)]), np.append(-target, np.zeros(p))


def gauss_newton_step(
    jacobian: Array, residual: Array, below: Array, above: Array, damping: float = 1e-3
) -> Array:
    """Damped Gauss-Newton step within the bounds, scaled by the columns of the Jacobian.

    below, above: bounds of the step (p,);  returns: (p,), NaN where the Jacobian is not finite
    """
    size, triangle, target = reduce_to_triangle(jacobian, residual)
    if not np.isfinite(size).all():
        return np.full(len(size), np.nan)
    rows, right = add_damping(triangle, target, damping + LEAST_DAMPING)
    step = np.linalg.lstsq(rows, right, rcond=None)[0]
    if np.any(step < below * size) or np.any(step > above * size):
        low, high = below * size, above * size
        high = np.where(high - low > 0, high, low + 1e-300)  # a range may have shrunk to nothing
        step = lsq_linear(rows, right, (low, high), method="bvls").x
    return np.asarray(step / size)


#: added to the scaled diagonal of normal equations: an undetermined parameter then stays zero
RIDGE = 1e-9


def solve_normal(normal: Array, gradient: Array) -> Array:
    """Solutions (..., k) of normal equations (..., k, k), each scaled to a unit diagonal."""
    scale = np.sqrt(np.maximum(np.diagonal(normal, axis1=-2, axis2=-1), 1e-300))
    scaled = normal / (scale[..., :, None] * scale[..., None, :]) + RIDGE * np.eye(scale.shape[-1])
    return np.asarray(np.linalg.solve(scaled, (gradient / scale)[..., None])[..., 0] / scale)

"""How the residual depends on a variable, estimated on fit records and tested on check records.

With each dependence the model's parameters are free (to first order), so that a dependence is not
reported where another value of a parameter explains the residual. The weight of the roughness
penalty is chosen with blocks of the fit records held out in turn. The score is the gain on rows
that were not used for the estimate, in standard deviations of its chance part, by blocks: see
`evidence`.

Whether a dependence holds in both directions, and whether it needs the body to have rested.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..diagnose.criteria import CRITERIA
from ..diagnose.evidence import chance, gain_score
from ..diagnose.fit import standard_errors
from ..diagnose.least_squares import solve_normal
from ..measurement.filtering import Array
from ..measurement.friction_curve import FOLDS
from .library import wave_number
from .rows import RESTED, Rows
from .shapes import SHAPES, Shape, columns_of, knots_of, roughness, shapes_of

#: weights of the roughness penalty that are compared, relative to the weight of the data
SMOOTHNESS = np.logspace(-4, 3, 8)
#: weight of a penalty on the size of f, relative to the data: a part that other values of the
#: model's parameters explain as well is left to the parameters, and f is lowered by a thousandth
SMALLNESS = 1e-3
#: probability that a dependence is reported for a right model, over all dependences that are tested
ALARM = 0.01


@dataclass(frozen=True)
class Columns:
    """Weighted regressor columns (n, k), and a penalty (k, k) on their coefficients."""

    values: Array
    penalty: Array

    def beside(self, other: Columns) -> Columns:
        """Both sets of columns in one."""
        k, m = len(self.penalty), len(other.penalty)
        penalty = np.zeros((k + m, k + m))
        penalty[:k, :k], penalty[k:, k:] = self.penalty, other.penalty
        return Columns(np.hstack([self.values, other.values]), penalty)

    def solve(self, target: Array, rows: NDArray[np.bool_]) -> Array:
        """Coefficients (k,) by penalised least squares on these rows."""
        a = self.values[rows]
        normal = a.T @ a + self.penalty
        return solve_normal(normal, a.T @ target[rows])


@dataclass(frozen=True)
class Dependence:
    """One dependence with its test.

    knots: of f, see `shapes.knots_of`;  columns: as fitted, weighted;  coefficients: of f (k,)
    before, after: weighted residual of the checked rows without and with it
    score: gain on the checked rows in standard deviations of chance
    probability: that chance alone gives this score to one or more of all tested dependences
    explained: part of the squares on the checked rows that it removes
    alike: names of other dependences that explain as much
    """

    shape: Shape
    knots: Array
    columns: Columns
    coefficients: Array
    before: Array
    after: Array
    score: float
    probability: float
    explained: float
    alike: tuple[str, ...] = field(default=())

    @property
    def squares(self) -> float:
        """Sum of squares that the dependence leaves on the checked rows."""
        return float(self.after @ self.after)


def model_columns(rows: Rows) -> Columns:
    """The columns of the model's free parameters: weighted and normalised, without penalty."""
    values = rows.tangents * rows.root[:, None]
    size = np.linalg.norm(values, axis=0)
    values = values[:, size > 0] / size[size > 0]
    return Columns(values, np.zeros((values.shape[1],) * 2))


def shape_columns(rows: Rows, shape: Shape, left: Array) -> tuple[Array, Columns] | None:
    """Knots and columns of a shape, without smoothing; None where no row depends on it.

    left: weighted residual (n,) in which a sinusoid is searched
    """
    knots = np.zeros(1)
    if shape.is_wave:
        knots = np.array([wave_number(rows, left, shape)])
    elif shape.variable is not None:
        knots = knots_of(shape.variable, rows)
    if not len(knots):
        return None
    values = columns_of(shape, knots, rows) * rows.root[:, None]
    size = float(np.sum(values**2)) / values.shape[1]
    if size == 0.0:
        return None
    return knots, Columns(values, SMALLNESS * size * np.eye(values.shape[1]))


def predict_held_out(rows: Rows, columns: Columns) -> Array:
    """Weighted residual of the checked rows, less the prediction of columns fitted elsewhere."""
    target = rows.residual * rows.root
    left = np.zeros_like(target)
    for train, test in rows.splits:
        left[test] = target[test] - columns.values[test] @ columns.solve(target, train)
    return left[rows.checked]


def fit_dependence(
    rows: Rows, beside: Columns, shape: Shape, knots_and_columns: tuple[Array, Columns]
) -> Dependence:
    """Estimate one dependence together with other columns, and test it on the checked rows."""
    knots, columns = knots_and_columns
    if shape.variable is not None and not shape.is_wave:
        columns = _with_smoothness(rows, beside, columns, roughness(shape, knots))
    together = beside.beside(columns)
    before, after = predict_held_out(rows, beside), predict_held_out(rows, together)
    score = gain_score(before, after, rows.blocks[rows.checked])
    return Dependence(
        shape=shape,
        knots=knots,
        columns=columns,
        coefficients=together.solve(rows.residual * rows.root, rows.learnt)[len(beside.penalty) :],
        before=before,
        after=after,
        score=score,
        probability=min(1.0, len(SHAPES) * chance(score)),
        explained=1.0 - float(after @ after) / max(float(before @ before), 1e-300),
    )


def _with_smoothness(rows: Rows, beside: Columns, columns: Columns, rough: Array) -> Columns:
    """Columns with the roughness penalty that best predicts held-out blocks."""
    target = rows.residual * rows.root
    where = np.flatnonzero(rows.learnt)
    together = beside.beside(columns)
    every, n = together.values, len(columns.penalty)
    part = rows.blocks[where] % FOLDS
    held = [where[part == fold] for fold in range(FOLDS)]
    normal = np.array([every[k].T @ every[k] for k in held])
    gradient = np.array([every[k].T @ target[k] for k in held])
    others = normal.sum(axis=0) - normal + together.penalty
    size = np.trace(columns.penalty) / (n * SMALLNESS)

    def missed(weight: float) -> float:
        penalised = others.copy()
        penalised[:, -n:, -n:] += weight * size * rough
        x = solve_normal(penalised, gradient.sum(axis=0) - gradient)
        bent = np.einsum("fi,fij,fj->", x, normal, x)
        return float(bent - 2 * np.einsum("fi,fi->", x, gradient))

    weight = min(SMOOTHNESS.tolist(), key=missed)
    return replace(columns, penalty=columns.penalty + weight * size * rough)


def is_not_itself(rows: Rows, beside: Columns, dependence: Dependence) -> bool:
    """Whether a dependence on a signal that contains the residual is more than self-correlation.

    At steady speed the command is the force of the model plus the residual, so it follows any
    residual: most of the gain must also appear with the variable as the model predicts it.
    """
    variable = dependence.shape.variable
    if variable is None or not variable.expected:
        return True
    expected = replace(variable, name=variable.expected, expected="")
    shape = replace(dependence.shape, variable=expected)
    columns = shape_columns(rows, shape, rows.residual)
    return columns is not None and (
        fit_dependence(rows, beside, shape, columns).explained
        > CRITERIA.mostly * dependence.explained
    )


def is_real(dependence: Dependence, whole: float, floor_squares: float) -> bool:
    """Whether the checked rows support a dependence, by more than chance and by enough to matter.

    whole: squares on the checked rows that the model leaves
    floor_squares: squares that the sensors alone leave there
    The thresholds are those for an effect of the ladder, whose small gains may be errors of the
    method. A gain above all that the sensors leave must only exceed chance.
    """
    gain = float(dependence.before @ dependence.before) - dependence.squares
    of_floor = CRITERIA.of_floor if dependence.score > CRITERIA.significance else 1.0
    least = max(CRITERIA.relative_improvement * whole, of_floor * floor_squares)
    return dependence.probability < ALARM and gain > least


def dependences(
    rows: Rows, floor_squares: float, *, most: int = 3
) -> tuple[tuple[Dependence, ...], tuple[Dependence, ...]]:
    """The dependences of the residual, largest first, and every test of the first round.

    floor_squares: squares that the sensors alone leave on the checked rows
    most: largest number of dependences
    Each dependence is fitted beside those before it.
    """
    target = rows.residual * rows.root
    whole = float(np.sum(target[rows.checked] ** 2))
    known = {s: shape_columns(rows, s, target) for s in shapes_of(rows)}
    beside, chosen = model_columns(rows), list[Dependence]()
    first: tuple[Dependence, ...] = ()
    while len(chosen) < most:
        left = target - beside.values @ beside.solve(target, rows.learnt)
        tests = []
        for shape, columns in known.items():
            if shape.is_wave and chosen:
                columns = shape_columns(rows, shape, left)
            if columns is not None:
                tests.append(fit_dependence(rows, beside, shape, columns))
        first = first or tuple(sorted(tests, key=lambda t: t.squares))
        real = [
            t for t in tests if is_real(t, whole, floor_squares) and is_not_itself(rows, beside, t)
        ]
        if not real:
            break
        chosen.append(_simplest(real))
        beside = beside.beside(chosen[-1].columns)
    return tuple(chosen), first


def _simplest(real: list[Dependence]) -> Dependence:
    """The first in `SHAPES` of those that explain as much as the best one."""
    best = max(t.explained for t in real)
    alike = [t for t in real if t.explained > (1.0 - CRITERIA.relative_improvement) * best]
    return replace(alike[0], alike=tuple(t.shape.name for t in alike[1:]))


#: part of the squares of a dependence that each side must have, so that the sides can be compared
SHARE = 0.1
#: size on one side, relative to the other side, below which the effect is "only" on the other side
ONLY = 0.25


@dataclass(frozen=True)
class Contrast:
    """The size of a dependence on two sides, relative to its overall size, with standard errors.

    sides: such as ("forward", "backward");  sizes, errors: (2,)
    """

    sides: tuple[str, str]
    sizes: Array
    errors: Array

    @property
    def differs(self) -> bool:
        """Whether the sides differ by more than chance."""
        return bool(abs(np.diff(self.sizes)[0]) > CRITERIA.significance * np.hypot(*self.errors))

    @property
    def only(self) -> str:
        """The only side on which the dependence exists; "" where it exists on both."""
        weak = int(np.argmin(np.abs(self.sizes)))
        strong = self.sizes[1 - weak]
        return self.sides[1 - weak] if self.differs and self.sizes[weak] < ONLY * strong else ""


def contrasts(rows: Rows, dependence: Dependence, left: Array) -> tuple[Contrast, ...]:
    """Sizes of the dependence forward and backward, and after a rest and after a mere reversal.

    left: weighted residual (n,) that the dependence describes
    """
    whole = dependence.columns.values @ dependence.coefficients
    direction, rested = rows.at("direction"), rows.at("rested")
    pairs = (
        (("forward", "backward"), direction > 0, direction < 0),
        (("after it has rested", "after a mere reversal"), rested >= RESTED, rested < RESTED),
    )
    candidates = [_contrast(rows, sides, a, b, whole, left) for sides, a, b in pairs]
    return tuple(c for c in candidates if c is not None)


def _contrast(
    rows: Rows,
    sides: tuple[str, str],
    one: NDArray[np.bool_],
    other: NDArray[np.bool_],
    whole: Array,
    left: Array,
) -> Contrast | None:
    columns = np.column_stack([whole * one, whole * other])
    size = np.sum(columns**2, axis=0)
    if size.min() < SHARE * size.sum():
        return None
    # the other columns of the model would blur the sides: each is held against what is left as is
    sizes = np.linalg.lstsq(columns, left, rcond=None)[0]
    errors = standard_errors(columns, left - columns @ sizes, rows.blocks)
    return Contrast(sides, np.asarray(sizes), errors)

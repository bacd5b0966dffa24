"""A dependence as it appears in the residual: a smooth curve with a band, and binned means.

Ranges of a curve where the device needs more force than the model, or less, with sizes.

The first ranges are those with most of the residual's squares, not those with the largest f: a
curve is large at its ends, where few rows are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..measurement.filtering import Array
from .dependence import Columns, Dependence, model_columns
from .rows import Rows
from .shapes import LOST, Shape, functions_of

#: half width of a band, in standard deviations
BAND = 2.0
#: points of a curve, and bins of the means beside it
POINTS, BINS = 161, 14
#: a row determines the curve if its carrier (the factor of the curve) is above this part of the
#: largest carrier
TELLS = 0.05


@dataclass(frozen=True)
class Curve:
    """f of a shape, estimated on fit records, with means over the checked rows.

    x: values of the variable (g,), one zero where there is none;  y, low, high: f and its band (g,)
    means: rows x, y, low, high of the binned means (4, b)
    weight: sum of squares of the carrier in the rows nearest to each x (g,) All SI; the band holds
        under residuals that are correlated within a quarter of a second.
    """

    x: Array
    y: Array
    low: Array
    high: Array
    means: Array
    weight: Array


def curve_of(rows: Rows, dependence: Dependence, earlier: tuple[Dependence, ...] = ()) -> Curve:
    """The curve in the residual without the earlier dependences.

    A constant, a sinusoid and a lost command have their full size, estimated with the model's
    parameters free. Other curves are the residual of the model with its present parameters.
    """
    left = rows.residual * rows.root
    for before in earlier:
        left = left - before.columns.values @ before.columns.solve(left, rows.learnt)
    variable = dependence.shape.variable
    alone = variable is not None and not variable.wave and not dependence.shape.of_command
    columns = dependence.columns if alone else model_columns(rows).beside(dependence.columns)
    value, spread = _coefficients(rows, columns, left, len(dependence.columns.penalty))
    x = _grid(rows, dependence.shape, dependence.knots)
    functions = functions_of(dependence.shape, dependence.knots, x)
    y = value @ functions
    half = BAND * np.sqrt(np.maximum(np.einsum("ig,ij,jg->g", functions, spread, functions), 0.0))
    means, weight = _means(rows, dependence.shape, left, x), _weight(rows, dependence.shape, x)
    if dependence.shape.carrier == LOST and variable is None:
        # counted so far in what arrives, for residuals are referred to that: c / (1 + c) of all
        low, y, high = (c / (1.0 + c) for c in (y - half, y, y + half))
        return Curve(x, y, low, high, means, weight)
    return Curve(x, y, y - half, y + half, means, weight)


def _coefficients(rows: Rows, columns: Columns, left: Array, last: int) -> tuple[Array, Array]:
    """The last `last` coefficients (k,) and their covariance (k, k).

    In penalised least squares, the covariance with the smoothness as a prior gives bands that cover
    the truth across the curve. The noise is that of block sums, because rows are correlated. Wahba,
    J. R. Stat. Soc. B 45 (1983) 133.
    """
    learnt = rows.learnt
    a, target = columns.values[learnt], left[learnt]
    value = columns.solve(left, learnt)
    normal = a.T @ a + columns.penalty
    size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    inverse = np.linalg.pinv(normal / np.outer(size, size), hermitian=True) / np.outer(size, size)
    scores = np.zeros((int(rows.blocks.max()) + 1, a.shape[1]))
    np.add.at(scores, rows.blocks[learnt], a * (target - a @ value)[:, None])
    noise = float(np.einsum("bi,ij,bj->", scores, inverse, scores)) / max(
        float(np.einsum("ij,ji->", inverse, a.T @ a)), 1e-300
    )
    return value[-last:], noise * inverse[-last:, -last:]


def _grid(rows: Rows, shape: Shape, knots: Array) -> Array:
    variable = shape.variable
    if variable is None:
        return np.zeros(1)
    if variable.wave:
        values = rows.at(variable.name)[rows.learnt]
        values = values[np.isfinite(values)]
        return np.linspace(values.min(), values.max(), POINTS)
    place = np.linspace(0, len(knots) - 1, POINTS)
    one = np.interp(place, np.arange(len(knots)), knots)
    return np.concatenate([-one[::-1], one]) if variable.signed else one


def _weight(rows: Rows, shape: Shape, x: Array) -> Array:
    if shape.variable is None:
        return np.ones(1)
    value = rows.at(shape.variable.name)
    known = np.isfinite(value)
    near = np.searchsorted(0.5 * (x[1:] + x[:-1]), value[known])
    squares = (shape.carrier.along(rows.at) * rows.root)[known] ** 2
    return np.asarray(np.bincount(near, squares, minlength=len(x)))


def _means(rows: Rows, shape: Shape, left: Array, x: Array) -> Array:
    """Means over bins of the checked rows with their bands: rows x, mean, low, high (4, b)."""
    if shape.variable is None:
        return np.zeros((4, 0))
    carrier = shape.carrier.along(rows.at) * rows.root
    value = rows.at(shape.variable.name)
    visible = rows.checked & (np.abs(carrier) > TELLS * np.abs(carrier).max()) & np.isfinite(value)
    edges = x[np.linspace(0, len(x) - 1, BINS + 1).astype(int)]
    means = []
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        cell = visible & (value >= low) & (value < high)
        blocks = np.unique(rows.blocks[cell])
        if len(blocks) < 3:
            continue
        c, r = carrier[cell], left[cell]
        mean = float(c @ r / (c @ c))
        sums = np.bincount(rows.blocks[cell], c * (r - mean * c))[blocks]
        half = BAND * float(np.sqrt(np.sum(sums**2) * len(blocks) / (len(blocks) - 1)) / (c @ c))
        means.append((float(np.average(value[cell], weights=c**2)), mean, mean - half, mean + half))
    return np.array(means).T.reshape(4, -1)


def without_columns(dependence: Dependence) -> Dependence:
    """The dependence without its columns, to save memory."""
    none = Columns(np.zeros((0, len(dependence.coefficients))), dependence.columns.penalty)
    return replace(dependence, columns=none)


#: least part of all squares in a range that is named
NAMED = 0.1
#: part of the rows outside a range at an end, below which the range is said to reach this end
NONE_BEYOND = 0.02
#: most ranges that are named; and number of ranges from which the text says "goes up and down"
MOST, TURNS = 3, 4


@dataclass(frozen=True)
class SignRegion:
    """A range of the variable (SI) where f keeps its sign and at least half of its extreme value.

    low, high: infinite where the range continues to the end of the known values
    extreme: f of largest size in the range
    share: part of the squares of the whole curve, in the run where f has this sign
    backward: the variable is negative here
    """

    low: float
    high: float
    extreme: float
    share: float
    backward: bool


def regions_of(curve: Curve, *, signed: bool = False) -> tuple[SignRegion, ...]:
    """The ranges where f differs from zero by more than its band, largest share of squares first.

    signed: f has a separate branch for each sign of the variable
    """
    half = len(curve.x) // 2
    parts = [slice(None, half), slice(half, None)] if signed else [slice(None)]
    squares = curve.weight * curve.y**2
    whole = max(float(squares.sum()), 1e-300)
    regions = []
    for part in parts:
        x, y, low, high = (a[part] for a in (curve.x, curve.y, curve.low, curve.high))
        sure = np.where((low > 0) | (high < 0), np.sign(y), 0.0)
        for run in _runs(sure):
            share = float(squares[part][run].sum()) / whole
            regions.append(_region(x, y, run, share, curve.weight[part]))
    regions.sort(key=lambda r: -r.share)
    return tuple(regions)


def largest_regions(regions: tuple[SignRegion, ...]) -> tuple[SignRegion, ...]:
    """The first range, and further ones of more than a tenth of the squares, from low to high."""
    chosen = regions[:1] + tuple(r for r in regions[1:MOST] if r.share > NAMED)
    return tuple(sorted(chosen, key=lambda r: r.low))


def goes_up_and_down(regions: tuple[SignRegion, ...]) -> bool:
    """Whether the curve has too many ranges to name them one by one."""
    return sum(r.share > 0.5 * NAMED for r in regions) >= TURNS


def _runs(sign: Array) -> list[slice]:
    """Runs of one sign; an uncertain part between two runs of one sign does not separate them."""
    edges = np.flatnonzero(np.diff(sign)) + 1
    runs: list[slice] = []
    for a, b in zip([0, *edges], [*edges, len(sign)], strict=True):
        if sign[a] == 0:
            continue
        if runs and sign[runs[-1].start] == sign[a]:
            runs[-1] = slice(runs[-1].start, int(b))
        else:
            runs.append(slice(int(a), int(b)))
    return runs


def _region(x: Array, values: Array, run: slice, share: float, weight: Array) -> SignRegion:
    size = np.abs(values)
    top = run.start + int(np.argmax(size[run]))
    large = (size > 0.5 * size[top]) & (np.sign(values) == np.sign(values[top]))
    low = top - int(np.argmin(np.append(large[top::-1], False))) + 1
    high = top + int(np.argmin(np.append(large[top:], False))) - 1
    few = NONE_BEYOND * float(weight.sum())
    return SignRegion(
        low=-np.inf if weight[:low].sum() <= few else float(x[low]),
        high=np.inf if weight[high + 1 :].sum() <= few else float(x[high]),
        extreme=float(values[top]),
        share=share,
        backward=bool(x[top] < 0),
    )

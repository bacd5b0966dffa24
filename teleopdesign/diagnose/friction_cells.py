"""Least friction in cells of position and direction, also where the model lacks something.

Where a body surely slides, the friction of the model and the residual together are the friction
that the records show, with all that the model lacks in it. Inertia and forces of the model could
have taken up a part of what varies along the way. So they are fitted again beside one level for
each cell, and the uncertainty of that fit counts against the friction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..blocks import NINETY_FIVE
from ..measurement.filtering import FORGOTTEN, Array
from ..measurement.prepare import Prepared, Stretch
from ..model import Model
from ..realise.along_motion import residual_along
from ..realise.friction_cells import FrictionCell
from .record_offsets import as_logged
from .residual import residuals
from .solve import BLOCK, free_parameters

#: cells along the travel; fewest independent samples of a cell, and fewest passes. More cells find
#: narrower zones with fewer samples in each: of 20 s, half of 20 cells have enough. The scatter of
#: ten samples is known to a quarter; what happened in one pass only may be no property of the place
CELLS, FEWEST, PASSES = 20, 10, 3
#: share of the friction in a cell that may lie below its least, and confidence in that bound
QUANTILE, CONFIDENCE = 0.025, 0.95


@dataclass(frozen=True)
class _Rows:
    """Rows of sure sliding, (n,), SI; tangents: (n, p) by the forces that are no friction.

    way: direction of motion;  friction: against the motion;  run: number of the pass
    stretch: number of the stretch;  seconds: of the record that a row stands for
    """

    position: Array
    speed: Array
    way: NDArray[np.intp]
    friction: Array
    tangents: Array
    run: NDArray[np.intp]
    stretch: NDArray[np.intp]
    time: Array
    seconds: Array


def friction_cells(model: Model, prepared: Prepared, place: str) -> tuple[FrictionCell, ...]:
    """Least friction of a body in the cells of its travel.

    place: name of the body
    returns: none for an arm's joint, whose links are estimated with it, for a body without friction
        in the model, and where all positions of the records have offsets of their own
    """
    stretches = [s for s in prepared.stretches if s.motion.body == place and not s.has_zero_offset]
    if prepared.is_linked or model.body(place).level() == 0 or not stretches:
        return ()
    rows = _rows_of(model, stretches, place, prepared.bandwidth)
    lowest = min(float(s.motion.position.min()) for s in stretches)
    highest = max(float(s.motion.position.max()) for s in stretches)
    edges = np.linspace(lowest, highest, CELLS + 1)
    if not len(rows.time) or not edges[-1] > edges[0]:
        return ()
    cell = np.clip(np.searchsorted(edges, rows.position, side="right") - 1, 0, CELLS - 1)
    friction, independent = _refit(rows, 2 * cell + (rows.way > 0), prepared.bandwidth)
    # slower than this, the low-pass shows what varies from cell to cell
    slow = rows.speed <= (edges[1] - edges[0]) * prepared.bandwidth
    cells = []
    for k in range(CELLS):
        for way in (1, -1):
            inside = (cell == k) & (rows.way == way) & slow
            number, least = _least(rows, friction, inside, independent)
            passed = edges[k : k + 2] if np.isnan(least) else rows.position[inside]
            low, high = float(passed.min()), float(passed.max())
            cells.append(FrictionCell(low, high, way, number, least))
    return tuple(cells)


def all_friction_cells(model: Model, prepared: Prepared) -> dict[str, tuple[FrictionCell, ...]]:
    """Body -> its cells, for the bodies that have some."""
    cells = {place: friction_cells(model, prepared, place) for place in model.bodies}
    return {place: made for place, made in cells.items() if made}


def _rows_of(model: Model, stretches: Sequence[Stretch], place: str, bandwidth: float) -> _Rows:
    """The rows in which the body surely slides, far enough from every reversal."""
    forces = [n for n in free_parameters(model) if _is_no_friction(model, n, place)]
    parts = residuals(model, stretches, forces)
    columns = []
    for k, (stretch, (residual, tangents)) in enumerate(zip(stretches, parts, strict=True)):
        motion = stretch.motion
        along = residual_along(model.body(place), as_logged(model, motion))
        ways = motion.direction.astype(int)
        run = np.concatenate([[0], np.cumsum(np.diff(ways) != 0)])
        first = np.searchsorted(run, run, side="left")
        last = np.searchsorted(run, run, side="right")
        row, here = np.arange(len(run)), FORGOTTEN / bandwidth / motion.sample_time
        sure = (ways != 0) & ((row - first >= here) | (first == 0))
        sure &= (last - 1 - row >= here) | (last == len(run))
        kept = sure[stretch.keep]
        rows = stretch.keep[kept]
        way = ways[rows]
        friction = way * (motion.lowpassed(along.friction.value)[rows] + residual[kept])
        columns.append(
            (
                motion.position[rows],
                np.abs(motion.velocity[rows]),
                way,
                friction,
                (way * tangents[:, kept]).T,
                run[rows],
                np.full(len(rows), k),
                motion.time[rows],
                np.full(len(rows), stretch.weight * motion.sample_time),
            )
        )
    return _Rows(*(np.concatenate(column) for column in zip(*columns, strict=True)))


def _is_no_friction(model: Model, name: str, place: str) -> bool:
    """Whether a parameter belongs to the inertia or to a force of the body."""
    holder, local_name = model.locate(name)
    effect = local_name.rpartition(".")[0]
    body = model.body(place)
    return holder == place and (
        not effect or (body.has(effect) and body.effect(effect).role == "force")
    )


def _refit(rows: _Rows, cell: NDArray[np.intp], bandwidth: float) -> tuple[Array, float]:
    """Friction (n,) with the forces fitted beside one level a cell; and s between samples."""
    number = np.maximum(np.bincount(cell), 1)

    def beside_levels(values: Array) -> Array:
        return values - (np.bincount(cell, values) / number)[cell]

    columns = np.column_stack([beside_levels(t) for t in rows.tangents.T] or [np.zeros(len(cell))])
    step = -np.linalg.lstsq(columns, beside_levels(rows.friction), rcond=None)[0]
    tangents = rows.tangents if rows.tangents.shape[1] else np.zeros((len(cell), 1))
    friction = rows.friction + tangents @ step
    left = beside_levels(friction)
    apart = _correlation_time(rows, left)
    spread = left @ left / len(left) * max(apart / float(np.median(rows.seconds)), 1.0)
    covariance = np.linalg.pinv(columns.T @ columns) * spread
    error = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", tangents, covariance, tangents), 0.0))
    return friction - NINETY_FIVE * error, apart


def _correlation_time(rows: _Rows, left: Array) -> float:
    """Integrated correlation time of what is left beside the levels, s."""
    sums, pairs, step = np.zeros(1), np.zeros(1), float(np.median(rows.seconds))
    for k in np.unique(rows.stretch):
        here = rows.stretch == k
        at = np.rint((rows.time[here] - rows.time[here][0]) / step).astype(int)
        values, there = np.zeros(at[-1] + 1), np.zeros(at[-1] + 1)
        values[at], there[at] = left[here], 1.0
        lags = min(len(values), max(round(4 * BLOCK / step), 1))
        size = 2 ** int(2 * len(values) - 1).bit_length()
        squares = [np.abs(np.fft.rfft(x, size)) ** 2 for x in (values, there)]
        products = [np.fft.irfft(square, size)[:lags] for square in squares]
        longer = max(lags, len(sums))
        sums, pairs = (
            np.pad(a, (0, longer - len(a))) + np.pad(b, (0, longer - len(b)))
            for a, b in zip((sums, pairs), products, strict=True)
        )
    mean = sums / np.maximum(pairs, 0.5)
    correlation = mean / max(mean[0], 1e-300)
    below = np.flatnonzero(correlation <= 0.0)
    end = int(below[0]) if len(below) else len(correlation)
    return step * float(1 + 2 * correlation[1:end].sum())


def _least(
    rows: _Rows, friction: Array, inside: NDArray[np.bool_], apart: float
) -> tuple[float, float]:
    """Number of independent samples of a cell, and the least friction in it; NaN: too few.

    The least is the 2.5 % quantile, or below: few samples seldom hold their own quantile. So it is
    also at most the bound above which 97.5 % of a normal scatter lie, with a confidence of 95 %.

    apart: s between independent samples
    """
    from scipy.stats import nct, norm

    passes = np.unique(np.column_stack([rows.stretch[inside], rows.run[inside]]), axis=0)
    number = 0.0
    for stretch, run in passes:
        in_pass = inside & (rows.stretch == stretch) & (rows.run == run)
        number += max(1.0, float(rows.seconds[in_pass].sum()) / apart)
    if number < FEWEST or len(passes) < PASSES:
        return number, np.nan
    there, root = friction[inside], np.sqrt(number)
    factor = nct.ppf(CONFIDENCE, number - 1, -norm.ppf(QUANTILE) * root) / root
    return number, float(min(np.quantile(there, QUANTILE), there.mean() - factor * there.std()))

"""Belief in an effect: does it do what a free function of the motion would do in its place?

The noise floor tells what a right model leaves on a simulated device. A real device always leaves
more. So an effect is compared with free functions instead, beside the same model without the
effect: sums of forces with unknown factors, ridge splines of the velocity in each direction or of
the position, and memories of the past since the last reversal. An effect that explains as much as
the best of them has the right form, however much of something else is left. Where a free function
explains much more, the form is wrong, however little is left.

All sums of squares are of rows that were not fitted: those of the check records, or of blocks that
are held out in turn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from ..base.frozen import ByValue
from ..measurement.filtering import Array
from ..measurement.friction_curve import FOLDS
from ..measurement.motion import Motion
from ..measurement.prepare import Prepared, Stretch
from .fit import Fit
from .least_squares import RIDGE
from .residual import relative_residuals

#: weights of the ridge, over the mean square of a column, one of which the folds choose
RIDGES = tuple(float(x) for x in np.geomspace(1e-6, 1.0, 7))
#: splines over a variable that has both signs, or none
SPLINES = 8
#: splines over the speed, in each direction
OF_SPEED = 6
#: travels and times over which the past is forgotten
MEMORIES = 4


@dataclass(frozen=True)
class Belief(ByValue):
    """What an effect explains, beside the best free function.

    rho: squares that it explains, over those that the free function explains; inf: this explains
        none
    lambda_: ln of the squares that the free function leaves over those that the effect leaves
    best: the free function: "velocity", "position" ...
    """

    rho: float
    lambda_: float
    best: str

    @property
    def share(self) -> float:
        """`rho` between 0 and 1: part of the squares that it explains where it explains less."""
        return min(self.rho, 1.0) if self.rho > 0.0 else 0.0


def belief(without: Fit, fit: Fit, at: str, prepared: Prepared) -> Belief:
    """How an effect compares with free functions of the motion of its body.

    without: the model fitted without the effect, and without what needs it
    fit: the model with the effect;  at: the place of the effect; what a body touches it touches
        with its own motion
    """
    problem = _problem(without, prepared, fit.model.holder(at))
    left = {name: problem.squares(columns) for name, columns in problem.families.items()}
    best = min(left, key=lambda name: left[name])
    alone, with_effect = problem.squares(), _problem(fit, prepared).squares()
    explained = alone - left[best]
    rho = (alone - with_effect) / explained if explained > 0.0 else np.inf
    return Belief(float(rho), float(np.log(left[best] / with_effect)), best)


@dataclass(frozen=True, eq=False)
class _Problem:
    """A linear problem: the residual of a model, its p tangents, and columns of free functions.

    folds: (FOLDS, m, m) products of these m rows in this order, over blocks of the fit records
    check: (m, m) the same over the check records; None: there are none
    stiff: number p of the model's own parameters: their ridge is next to none
    families: free function -> its rows
    """

    folds: Array
    check: Array | None
    stiff: int
    families: Mapping[str, range]

    def squares(self, free: Sequence[int] = ()) -> float:
        """Squares on rows that were not fitted: of the check records, or of each block in turn.

        free: rows of a free function; (): the model alone
        """
        chosen = [*range(1 + self.stiff), *free]
        folds = self.folds[:, chosen][:, :, chosen]
        if self.check is not None:
            return _squares(self.check[np.ix_(chosen, chosen)], self._factors(folds))
        return sum(
            _squares(block, self._factors(np.delete(folds, i, axis=0)))
            for i, block in enumerate(folds)
        )

    def _factors(self, folds: Array) -> Array:
        """The columns' factors, with the ridge that leaves least of blocks held out in turn."""
        others = [np.delete(folds, i, axis=0).sum(axis=0) for i in range(len(folds))]

        def left(ridge: float) -> float:
            pairs = zip(folds, others, strict=True)
            return sum(_squares(block, self._solve(rest, ridge)) for block, rest in pairs)

        is_free = folds.shape[1] > 1 + self.stiff
        return self._solve(folds.sum(axis=0), min(RIDGES, key=left) if is_free else RIDGES[0])

    def _solve(self, products: Array, ridge: float) -> Array:
        columns, with_residual = products[1:, 1:], products[1:, 0]
        size = np.sqrt(np.diag(columns))
        used = (size > 0.0) & np.isfinite(size)
        x = np.zeros(len(size))
        if not used.any():
            return x
        weights = np.where(np.arange(len(size)) < self.stiff, RIDGE, ridge)[used]
        matrix = columns[np.ix_(used, used)] / np.outer(size[used], size[used])
        target = with_residual[used] / size[used]
        x[used] = -np.linalg.lstsq(matrix + np.diag(weights), target, rcond=None)[0] / size[used]
        return x


def _squares(products: Array, x: Array) -> float:
    """Squares of the residual with the columns times x, by the products of these rows."""
    rows = np.append(1.0, x)
    return float(rows @ products @ rows)


def _problem(fit: Fit, prepared: Prepared, body: str | None = None) -> _Problem:
    """The problem of a model on its records.

    body: whose motion the free functions follow; None: there are none
    """
    known, check = prepared.of("fit"), prepared.of("check")
    forces = _free_forces([s.motion for s in known if s.motion.body == body])

    def rows(stretches: Sequence[Stretch]) -> list[Array]:
        """Per stretch the weighted residual above its tangents and the columns, (m, n)."""
        more = None
        if body is not None:
            each = ((s.motion.body == body, forces(s.motion).values()) for s in stretches)
            more = [mine * np.vstack(list(columns)) for mine, columns in each]
        parts = relative_residuals(fit.model, stretches, fit.free, more)
        weights = [np.sqrt(s.weight) for s in stretches]
        return [w * np.vstack([r[None], d]) for w, (r, d) in zip(weights, parts, strict=True)]

    families, first = dict[str, range](), 1 + len(fit.free)
    for name, columns in {} if body is None else forces(known[0].motion).items():
        families[name] = range(first, first + len(columns))
        first += len(columns)
    folds = zip(*(_blocks(r) for r in rows(known)), strict=True)
    return _Problem(
        np.array([_products(blocks) for blocks in folds]),
        _products(rows(check)) if check else None,
        len(fit.free),
        families,
    )


def _blocks(rows: Array) -> list[Array]:
    """The rows (m, n) in `FOLDS` blocks of successive ones."""
    return np.split(rows, rows.shape[1] * np.arange(1, FOLDS) // FOLDS, axis=1)


def _products(rows: Sequence[Array]) -> Array:
    whole = np.hstack(rows)
    return whole @ whole.T


def _free_forces(motions: Sequence[Motion]) -> Callable[[Motion], dict[str, Array]]:
    """Function from a motion to the forces (c, n) that each free function is a sum of.

    motions: of one body on its fit records: the knots of splines come from their ranges
    On a friction curve there are those of the velocity alone.
    """
    lows, highs = ([f(m.position) for m in motions] for f in (np.min, np.max))
    low, high = float(min(lows, default=0.0)), float(max(highs, default=1.0))
    top = max((float(np.abs(m.velocity).max()) for m in motions), default=1.0) or 1.0
    step = max((m.step for m in motions), default=1.0)

    def forces(motion: Motion) -> dict[str, Array]:
        direction, speed = motion.direction, np.abs(motion.velocity) / top
        # a curve over the speed, finer at low speeds, where friction changes
        over = _splines(np.sqrt(speed), 0.0, 1.0, OF_SPEED)
        of_velocity = np.vstack([(direction == 1) * over, (direction == -1) * over])
        if motion.is_curve:
            return {"velocity": of_velocity}
        of_place = _splines(motion.position, low, max(high, low + step), SPLINES)
        memory = _memory(motion, max(high - low, step), step)
        return {
            "velocity": of_velocity,
            "position": of_place,
            "position and direction": direction * of_place,
            "position and velocity": motion.velocity / top * of_place,
            "the past": memory,
            "the past and derivatives": np.vstack([memory, *_derivatives(motion)]),
        }

    return forces


def _splines(u: Array, low: float, high: float, count: int) -> Array:
    """Cubic splines (count, n) over low to high; constant beyond."""
    knots = np.linspace(low, high, count - 2)
    step = knots[1] - knots[0]
    knots = np.concatenate([low - step * np.arange(3, 0, -1), knots, high + step * np.arange(1, 4)])
    inside = np.clip(u, low, high - 1e-9 * (high - low))
    basis = BSpline.design_matrix(inside, knots, 3).toarray()
    return np.array(basis.T, dtype=float)


def _memory(motion: Motion, longest: float, step: float) -> Array:
    """Forces in the direction of motion that fade with travel, or time, since it last turned.

    longest: travel;  step: of a reading of the position
    """
    direction = motion.direction.astype(float)
    turned = np.flatnonzero(np.diff(direction, prepend=0.0) != 0.0)
    last = np.zeros(len(direction), dtype=np.intp)
    last[turned] = turned
    last = np.maximum.accumulate(last)
    travel = np.abs(motion.position - motion.position[last])
    elapsed = motion.time - motion.time[last]
    travels = np.geomspace(max(step, 1e-3 * longest), longest, MEMORIES)
    times = np.geomspace(1.0, 100.0, MEMORIES) / (2.0 * np.pi * motion.bandwidth)
    fading: Array = np.vstack(
        [np.exp(-travel[None] / travels[:, None]), np.exp(-elapsed[None] / times[:, None])]
    )
    return direction * fading


def _derivatives(motion: Motion) -> list[Array]:
    """Acceleration, jerk, and two derivatives of the command, (n,) each."""
    spectrum, command = motion.spectrum, motion.at_rows(motion.command)
    return [
        motion.acceleration,
        spectrum.multiply(motion.acceleration, spectrum.derivative(1)),
        spectrum.multiply(command, spectrum.derivative(1)),
        spectrum.multiply(command, spectrum.derivative(2)),
    ]

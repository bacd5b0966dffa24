"""Belief in an effect: does it do what a free function of the motion would do in its place?

The noise floor tells what a right model leaves on a simulated device. A real device always leaves
more. So an effect is compared with free functions instead: ridge splines of the velocity, of the
position, and of the past, beside the same model without the effect. An effect that explains as much
as the best of them has the right form, however much of something else is left. Where a free
function explains much more, the form is wrong, however little is left.

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
from ..measurement.motion import Motion
from ..measurement.prepare import FOLDS, Prepared, Stretch
from .fit import Fit
from .residual import relative_residuals

#: splines over a variable that has both signs, or none
SPLINES = 8
#: splines over the speed, in each direction
OF_SPEED = 6
#: travels and times over which the past is forgotten
MEMORIES = 4
#: weights of the ridge, over the mean square of a column, one of which the folds choose
RIDGES = tuple(float(x) for x in np.geomspace(1e-6, 1.0, 7))


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
        return min(max(self.rho, 0.0), 1.0)


def belief(without: Fit, fit: Fit, at: str, prepared: Prepared) -> Belief:
    """How an effect compares with free functions of the motion of its body.

    without: the model fitted without the effect, and without what needs it
    fit: the model with the effect;  at: the place of the effect
    """
    bare, whole = compare_free_functions(without, at, prepared), own_squares(fit, prepared)
    return bare.against(whole)


@dataclass(frozen=True)
class FreeFunctions(ByValue):
    """Squares that a model leaves on rows that were not fitted, alone and with free functions.

    alone: of the model alone;  left: free function -> squares with it
    """

    alone: float
    left: Mapping[str, float]

    def against(self, with_effect: float) -> Belief:
        """An effect that leaves these squares, beside the best free function."""
        best = min(self.left, key=lambda name: self.left[name])
        explained = self.alone - self.left[best]
        rho = (self.alone - with_effect) / explained if explained > 0.0 else np.inf
        return Belief(float(rho), float(np.log(self.left[best] / with_effect)), best)


def own_squares(fit: Fit, prepared: Prepared) -> float:
    """Squares that a model leaves on rows that were not fitted."""
    return _Problem.of(fit, prepared, None, "").squares()


def compare_free_functions(fit: Fit, at: str, prepared: Prepared) -> FreeFunctions:
    """A model alone, and with each free function of the motion of one body.

    at: the place of the force;  prepared: of the fit
    """
    left = {
        name: _Problem.of(fit, prepared, columns, at).squares()
        for name, columns in FAMILIES.items()
    }
    return FreeFunctions(own_squares(fit, prepared), left)


@dataclass(frozen=True)
class _Sums:
    """Sums of products over some rows: of the columns, with the residual, of the residual."""

    of_columns: Array
    with_residual: Array
    of_residual: float

    def __add__(self, other: _Sums) -> _Sums:
        return _Sums(
            self.of_columns + other.of_columns,
            self.with_residual + other.with_residual,
            self.of_residual + other.of_residual,
        )

    def squares(self, x: Array) -> float:
        """Squares of the residual with the columns times x."""
        return float(self.of_residual + 2.0 * x @ self.with_residual + x @ self.of_columns @ x)


@dataclass(frozen=True)
class _Problem:
    """A linear problem: the residual of a model, its tangents, and columns of a free function.

    parts: sums over the blocks of the fit records;  check: over the check records, if there are any
    stiff: number of the first columns, which have no ridge: the model's own parameters
    """

    parts: tuple[_Sums, ...]
    check: _Sums | None
    stiff: int

    @classmethod
    def of(cls, fit: Fit, prepared: Prepared, columns: Columns | None, at: str) -> _Problem:
        """columns: of the free function; None: none;  at: its body"""
        known, check = prepared.of("fit"), prepared.of("check")
        ranges = Ranges.of([s.motion for s in known if s.motion.body == at])
        rows = _rows(fit, known, columns, ranges, at)
        parts = [
            _sums([r[:, b] for r in rows for b in [_block(r.shape[1], k)]]) for k in range(FOLDS)
        ]
        checked = _sums(_rows(fit, check, columns, ranges, at)) if check else None
        return cls(tuple(parts), checked, len(fit.free))

    def squares(self) -> float:
        """Squares on rows that were not fitted: of the check records, or of each block in turn."""
        if self.check is not None:
            return self.check.squares(self.factors(self.parts))
        return sum(
            part.squares(self.factors(self._other_parts(i, self.parts)))
            for i, part in enumerate(self.parts)
        )

    def factors(self, parts: Sequence[_Sums]) -> Array:
        """The columns' factors, with the ridge that leaves least of blocks held out in turn."""

        def left(ridge: float) -> float:
            return sum(
                part.squares(self._solve(self._other_parts(i, parts), ridge))
                for i, part in enumerate(parts)
            )

        whole = len(parts[0].with_residual)
        ridge = min(RIDGES, key=left) if whole > self.stiff else RIDGES[0]
        return self._solve(parts, ridge)

    @staticmethod
    def _other_parts(i: int, parts: Sequence[_Sums]) -> list[_Sums]:
        return [part for j, part in enumerate(parts) if j != i]

    def _solve(self, parts: Sequence[_Sums], ridge: float) -> Array:
        sums = parts[0]
        for part in parts[1:]:
            sums = sums + part
        size = np.sqrt(np.diag(sums.of_columns))
        used = size > 0.0
        x = np.zeros(len(size))
        if not used.any():
            return x
        weights = np.where(np.arange(len(size)) < self.stiff, 1e-10, ridge)[used]
        matrix = sums.of_columns[np.ix_(used, used)] / np.outer(size[used], size[used])
        x[used] = (
            -np.linalg.lstsq(
                matrix + np.diag(weights), sums.with_residual[used] / size[used], rcond=None
            )[0]
            / size[used]
        )
        return x


def _rows(
    fit: Fit, stretches: Sequence[Stretch], columns: Columns | None, ranges: Ranges, at: str
) -> list[Array]:
    """Per stretch the weighted residual above its tangents and the free columns, (1 + p + c, n)."""
    free = None
    if columns is not None:
        count = len(columns(stretches[0].motion, ranges))
        free = [
            columns(s.motion, ranges)
            if s.motion.body == at
            else np.zeros((count, len(s.motion.time)))
            for s in stretches
        ]
    parts = relative_residuals(fit.model, stretches, fit.free, free)
    return [
        np.sqrt(s.weight) * np.vstack([r[None], d])
        for s, (r, d) in zip(stretches, parts, strict=True)
    ]


def _block(rows: int, number: int) -> slice:
    return slice(rows * number // FOLDS, rows * (number + 1) // FOLDS)


def _sums(rows: Sequence[Array]) -> _Sums:
    whole = np.hstack(rows)
    products = whole @ whole.T
    return _Sums(products[1:, 1:], products[1:, 0], float(products[0, 0]))


@dataclass(frozen=True)
class Ranges:
    """Ranges of the motion of one body on its fit records, for the knots of splines.

    position: least and largest;  speed, acceleration, jerk, rate, rate_of_rate: largest sizes
    step: of a reading of the position;  fast: s, shortest memory
    """

    position: tuple[float, float]
    speed: float
    step: float
    fast: float

    @classmethod
    def of(cls, motions: Sequence[Motion]) -> Ranges:
        if not motions:
            return cls((0.0, 1.0), 1.0, 1.0, 1.0)
        low = min(float(m.position.min()) for m in motions)
        high = max(float(m.position.max()) for m in motions)
        speed = max(float(np.abs(m.velocity).max()) for m in motions)
        first = motions[0]
        fast = 1.0 / (2.0 * np.pi * first.bandwidth)
        return cls((low, high), speed or 1.0, max(m.step for m in motions), fast)

    @property
    def travel(self) -> float:
        """Largest change of the position."""
        return max(self.position[1] - self.position[0], self.step)


#: (motion, ranges) -> forces (c, n) that a free function is a sum of
Columns = Callable[[Motion, Ranges], Array]


def _splines(u: Array, low: float, high: float, count: int) -> Array:
    """Cubic splines (count, n) over low to high; constant beyond."""
    knots = np.linspace(low, high, count - 2)
    step = knots[1] - knots[0]
    knots = np.concatenate([low - step * np.arange(3, 0, -1), knots, high + step * np.arange(1, 4)])
    inside = np.clip(u, low, high - 1e-9 * (high - low))
    basis = BSpline.design_matrix(inside, knots, 3).toarray()
    return np.array(basis.T, dtype=float)


def _curve_of_position(motion: Motion, ranges: Ranges) -> Array:
    low, high = ranges.position
    return _splines(motion.position, low, max(high, low + ranges.step), SPLINES)


def _curve_of_velocity(motion: Motion, ranges: Ranges) -> Array:
    """A curve over the speed in each direction; finer at low speeds, where friction changes."""
    over = _splines(np.sqrt(np.abs(motion.velocity) / ranges.speed), 0.0, 1.0, OF_SPEED)
    return np.vstack([(motion.direction == 1) * over, (motion.direction == -1) * over])


def _memory(motion: Motion, ranges: Ranges) -> Array:
    """Forces in the direction of motion that fade with travel, or time, since it last turned."""
    direction = motion.direction.astype(float)
    turned = np.flatnonzero(np.diff(direction, prepend=0.0) != 0.0)
    last = np.zeros(len(direction), dtype=np.intp)
    last[turned] = turned
    last = np.maximum.accumulate(last)
    travel = np.abs(motion.position - motion.position[last])
    elapsed = motion.time - motion.time[last]
    travels = np.geomspace(max(ranges.step, 1e-3 * ranges.travel), ranges.travel, MEMORIES)
    times = ranges.fast * np.geomspace(1.0, 100.0, MEMORIES)
    fading: Array = np.vstack(
        [np.exp(-travel[None] / travels[:, None]), np.exp(-elapsed[None] / times[:, None])]
    )
    return direction * fading


def _memory_and_derivatives(motion: Motion, ranges: Ranges) -> Array:
    command = motion.at_rows(motion.command)
    spectrum = motion.spectrum
    more = [
        motion.acceleration,
        spectrum.multiply(motion.acceleration, spectrum.derivative(1)),
        spectrum.multiply(command, spectrum.derivative(1)),
        spectrum.multiply(command, spectrum.derivative(2)),
    ]
    return np.vstack([_memory(motion, ranges), *more])


FAMILIES: Mapping[str, Columns] = {
    "velocity": _curve_of_velocity,
    "position": _curve_of_position,
    "position and direction": lambda m, r: m.direction * _curve_of_position(m, r),
    "position and velocity": lambda m, r: m.velocity / r.speed * _curve_of_position(m, r),
    "the past": _memory,
    "the past and derivatives": _memory_and_derivatives,
}

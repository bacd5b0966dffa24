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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..base.frozen import ByValue
from ..measurement.filtering import Array
from ..measurement.friction_curve import FOLDS
from ..measurement.prepare import Prepared, Stretch
from .fit import Fit
from .free_forces import MotionRanges, families
from .least_squares import RIDGE
from .residual import relative_residuals

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
        return min(self.rho, 1.0) if self.rho > 0.0 else 0.0


def belief(without: Fit, fit: Fit, at: str, prepared: Prepared) -> Belief:
    """How an effect compares with free functions of the motion of its body.

    without: the model fitted without the effect, and without what needs it
    fit: the model with the effect;  at: the place of the effect
    """
    return compare_free_functions(without, at, prepared).against(residual_squares(fit, prepared))


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


def residual_squares(fit: Fit, prepared: Prepared) -> float:
    """Squares that a model leaves on rows that were not fitted."""
    return _Problem.of(fit, prepared).squares()


def compare_free_functions(fit: Fit, at: str, prepared: Prepared) -> FreeFunctions:
    """A model alone, and with each free function of the motion of one body.

    at: the place of the force; what a body touches it touches with its own motion
    prepared: of the fit
    """
    problem = _Problem.of(fit, prepared, fit.model.holder(at))
    left = {name: problem.squares(columns) for name, columns in problem.families.items()}
    return FreeFunctions(problem.squares(), left)


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

    def part(self, columns: Sequence[int]) -> _Sums:
        """The sums of some columns alone."""
        chosen = np.asarray(columns, dtype=np.intp)
        return _Sums(
            self.of_columns[np.ix_(chosen, chosen)], self.with_residual[chosen], self.of_residual
        )

    def squares(self, x: Array) -> float:
        """Squares of the residual with the columns times x."""
        return float(self.of_residual + 2.0 * x @ self.with_residual + x @ self.of_columns @ x)


@dataclass(frozen=True)
class _Problem:
    """A linear problem: the residual of a model, its tangents, and columns of all free functions.

    parts: sums over the blocks of the fit records;  check: over the check records, if there are any
    stiff: number of the first columns, the model's own parameters: their ridge is next to none
    families: free function -> its columns
    """

    parts: tuple[_Sums, ...]
    check: _Sums | None
    stiff: int
    families: Mapping[str, Sequence[int]]

    @classmethod
    def of(cls, fit: Fit, prepared: Prepared, body: str | None = None) -> _Problem:
        """body: whose motion the free functions follow; None: there are none"""
        known, check, stiff = prepared.of("fit"), prepared.of("check"), len(fit.free)
        ranges = MotionRanges.of([s.motion for s in known if s.motion.body == body])
        columns: dict[str, range] = {}
        if body is not None:
            first = stiff
            for name, force in families(known[0].motion).items():
                count = len(force(known[0].motion, ranges))
                columns[name] = range(first, first + count)
                first += count
        rows = _rows(fit, known, ranges, body)
        parts = [_sums([r[:, _block(r.shape[1], k)] for r in rows]) for k in range(FOLDS)]
        checked = _sums(_rows(fit, check, ranges, body)) if check else None
        return cls(tuple(parts), checked, stiff, columns)

    def squares(self, free: Sequence[int] = ()) -> float:
        """Squares on rows that were not fitted: of the check records, or of each block in turn.

        free: columns of a free function; (): the model alone
        """
        columns = [*range(self.stiff), *free]
        parts = [part.part(columns) for part in self.parts]
        if self.check is not None:
            return self.check.part(columns).squares(self.factors(parts))
        return sum(
            part.squares(self.factors(self._other_parts(i, parts))) for i, part in enumerate(parts)
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
        used = (size > 0.0) & np.isfinite(size)
        x = np.zeros(len(size))
        if not used.any():
            return x
        weights = np.where(np.arange(len(size)) < self.stiff, RIDGE, ridge)[used]
        matrix = sums.of_columns[np.ix_(used, used)] / np.outer(size[used], size[used])
        x[used] = (
            -np.linalg.lstsq(
                matrix + np.diag(weights), sums.with_residual[used] / size[used], rcond=None
            )[0]
            / size[used]
        )
        return x


def _rows(
    fit: Fit, stretches: Sequence[Stretch], ranges: MotionRanges, body: str | None
) -> list[Array]:
    """Per stretch the weighted residual above its tangents and the free columns, (1 + p + c, n)."""
    forces = None
    if body is not None:
        forces = [
            np.vstack([force(s.motion, ranges) for force in families(s.motion).values()])
            * (s.motion.body == body)
            for s in stretches
        ]
    parts = relative_residuals(fit.model, stretches, fit.free, forces)
    weights = [np.sqrt(s.weight) for s in stretches]
    return [w * np.vstack([r[None], d]) for w, (r, d) in zip(weights, parts, strict=True)]


def _block(rows: int, number: int) -> slice:
    return slice(rows * number // FOLDS, rows * (number + 1) // FOLDS)


def _sums(rows: Sequence[Array]) -> _Sums:
    whole = np.hstack(rows)
    products = whole @ whole.T
    return _Sums(products[1:, 1:], products[1:, 0], float(products[0, 0]))

"""Search for values with which simulated signals follow measured ones, and standard errors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..base.errors import ModelError
from ..diagnose.fit import standard_errors
from ..diagnose.solve import BLOCK
from ..passivity.intervals.box import ValueBox
from ..studies.case import SimulatedCase
from ..studies.differences import SignalSlopes, simulated_signals, slopes_of
from .problem import AT_END, shares_of, start_values, unit_box, units_at, values_at

#: number of searches, which start from the best points of the first simulations
_SEARCHES = 3
#: most simulations of a search, besides those for its slopes
_EVALUATIONS = 60
#: least distance of the start of a search from the ends of an interval, as a share of the interval
_INSIDE = 1e-3
#: two searches agree if their values differ by less than this share of each interval
_SAME = 1e-2
#: singular value over the largest one, below which a combination of parameters has no influence:
#: the slopes are correct to about 1e-6 at best
_NO_INFLUENCE = 1e-5
#: a parameter is not determined if its part in such a combination is larger than this
_PART = 0.1
#: if the slopes for two sizes of step differ by more (relative), no standard error is derived from
#: them: with encoder steps in a stiff loop, errors were 20 times too small at 0.1 to 1
MOST_APART = 0.1
#: fewest blocks of a record, also of a short one
_BLOCKS = 30
#: least error of a signal, as a part of its size, so that an exact signal has a finite weight
_EXACTLY = 1e-6


@dataclass(frozen=True, eq=False)
class Target:
    """Measured signals (n,) at times (n,), s, and the noise (SI) of those for which it is known."""

    time: np.ndarray
    signals: Mapping[str, np.ndarray]
    noise: Mapping[str, float]

    def __post_init__(self) -> None:
        for name, level in self.noise.items():
            if name not in self.signals or not 0 < level < np.inf:
                raise ModelError(
                    f"fit_simulation: noise: {name}: found {level:g}, expected more than 0 of one "
                    f"of {', '.join(self.signals)}"
                )
        for name, values in self.signals.items():
            if not np.nanstd(values) > 0:
                raise ModelError(f'fit_simulation: data: "{name}" is constant or no number')

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the signals that the simulation should follow."""
        return tuple(self.signals)

    @property
    def values(self) -> np.ndarray:
        """All measured signals, (signals, n); NaN where there is no sample."""
        return np.stack(list(self.signals.values()))

    @property
    def size(self) -> np.ndarray:
        """Standard deviation of each signal, (signals,)."""
        return np.asarray(np.nanstd(self.values, axis=1))

    def at_times(self, time: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Simulated signals (..., rows) at the measured times (n,), linear between samples."""
        k = np.clip(np.searchsorted(time, self.time, side="right") - 1, 0, len(time) - 2)
        part = (self.time - time[k]) / (time[k + 1] - time[k])
        return np.asarray(rows[..., k] * (1 - part) + rows[..., k + 1] * part)

    def blocks(self) -> np.ndarray:
        """Block number of each instant, (n,); errors are correlated within a block."""
        lasts = self.time[-1] - self.time[0]
        numbers = ((self.time - self.time[0]) / min(BLOCK, lasts / _BLOCKS)).astype(int)
        return np.asarray(np.unique(numbers, return_inverse=True)[1])


@dataclass(frozen=True, eq=False)
class Followed:
    """Result of a search.

    values, errors: (p,) SI; errors are NaN at ends of intervals, where not `is_determined`, and all
        of them if the slopes of one parameter are more than MOST_APART apart
    apart: (p,) of the slopes over all signals, see `SignalSlopes`
    at_start: (signals, n) simulated with the diagram's values, NaN where they have no simulation
    searches: number of searches;  agreeing: searches with the same result
    """

    values: np.ndarray
    errors: np.ndarray
    is_at_end: np.ndarray
    is_determined: np.ndarray
    apart: np.ndarray
    slopes: SignalSlopes
    at_start: np.ndarray
    searches: int
    agreeing: int


@dataclass(frozen=True, eq=False)
class _Search:
    """Residuals of weighted signals over shares (0 to 1) of the parameters' intervals."""

    case: SimulatedCase
    box: ValueBox
    target: Target
    weights: np.ndarray

    def simulate(self, shares: np.ndarray) -> tuple[np.ndarray, list[str]]:
        """Signals (points, signals, n) at the measured times, and why a point has none."""
        points = values_at(self.box, np.atleast_2d(shares))
        time, rows, reasons = simulated_signals(
            self.case, self.box.names, points, self.target.names
        )
        many = (*rows.shape[:2], len(self.target.time))
        return self.target.at_times(time, rows) if len(time) else np.full(many, np.nan), reasons

    def flat(self, values: np.ndarray) -> np.ndarray:
        """Weighted signals (..., signals, n) where there are samples, flattened to (..., m)."""
        is_there = np.isfinite(self.target.values)
        return np.asarray((values * self.weights[:, None])[..., is_there])

    def residual(self, shares: np.ndarray) -> np.ndarray:
        """Weighted residual (m,); NaN without a simulation, so that the search steps back."""
        signals, _ = self.simulate(shares)
        return self.flat(signals[0] - self.target.values)

    def slopes(self, shares: np.ndarray) -> SignalSlopes:
        values = values_at(self.box, shares)
        units = units_at(self.box, values)
        return slopes_of(self.case, self.box.names, values, units, self.target.names)

    def jacobian(self, shares: np.ndarray, of: SignalSlopes | None = None) -> np.ndarray:
        """Derivatives of the residual by the shares, (m, p)."""
        of = self.slopes(shares) if of is None else of
        units = units_at(self.box, values_at(self.box, shares))
        return np.asarray(self.flat(self.target.at_times(of.time, of.slopes)).T * units)

    def minimise(self, shares: np.ndarray) -> tuple[float, np.ndarray]:
        """Sum of squares and shares at the end of a search from these shares."""
        from scipy.optimize import least_squares

        there = least_squares(
            self.residual,
            np.clip(shares, _INSIDE, 1 - _INSIDE),
            self.jacobian,
            bounds=(0.0, 1.0),
            x_scale="jac",
            max_nfev=_EVALUATIONS,
        )
        return float(there.cost), there.x


def follow(case: SimulatedCase, box: ValueBox, target: Target, starts: int, seed: int) -> Followed:
    """Search the box for values with which the simulation follows the target most closely.

    raises ModelError: no simulation at any of the points
    """
    search = _Search(case, box, target, 1 / _noise(target, target.size))
    first = shares_of(box, start_values(case, box))
    points = np.vstack([first, unit_box(box.names).inside(starts, seed)])
    signals, reasons = search.simulate(points)
    squares = np.sum(search.flat(signals - target.values) ** 2, axis=-1)
    order = [int(k) for k in np.argsort(squares) if np.isfinite(squares[k])]
    if not order:
        raise ModelError(f"fit_simulation: nowhere in the intervals a simulation: {reasons[0]}")
    ends = [search.minimise(points[k]) for k in order[:_SEARCHES]]
    _, best = min(ends, key=lambda end: end[0])
    agreeing = sum(bool(np.abs(x - best).max() < _SAME) for _, x in ends)
    if len(target.names) > 1 and len(target.noise) < len(target.names):
        left = rms_of(search.simulate(best)[0][0] - target.values)
        left = np.maximum(left, _EXACTLY * target.size)
        search = replace(search, weights=1 / _noise(target, left))
        _, best = search.minimise(best)
    return _judge(search, best, signals[0], (len(ends), agreeing))


def _judge(
    search: _Search, shares: np.ndarray, at_start: np.ndarray, searches: tuple[int, int]
) -> Followed:
    """The result of a search, with standard errors and the parameters that are determined."""
    of, target = search.slopes(shares), search.target
    jacobian = search.jacobian(shares, of)
    residual = search.flat(target.at_times(of.time, of.signals) - target.values)
    is_at_end = np.minimum(shares, 1 - shares) < AT_END
    is_determined = _is_determined(jacobian, ~is_at_end)
    sure = is_determined & ~is_at_end
    blocks = np.broadcast_to(target.blocks(), target.values.shape)
    weighed = np.sqrt(np.mean(of.slopes**2, axis=-1)) * search.weights
    absolute = np.linalg.norm(np.where(weighed > 0, of.apart * weighed, 0.0), axis=1)
    whole = np.linalg.norm(weighed, axis=1)
    apart = np.where(whole > 0, absolute / np.where(whole > 0, whole, 1.0), of.apart.max(axis=1))
    errors = np.full(len(shares), np.nan)
    if apart[sure].max(initial=0.0) <= MOST_APART:
        here = blocks[np.isfinite(target.values)]
        errors[sure] = standard_errors(jacobian[:, sure], residual, here)
    values = values_at(search.box, shares)
    units = units_at(search.box, values)
    return Followed(
        values, errors * units, is_at_end, is_determined, apart, of, at_start, *searches
    )


def _is_determined(jacobian: np.ndarray, is_free: np.ndarray) -> np.ndarray:
    """Mask (p,) of the parameters that take no part in a combination without influence."""
    size = np.linalg.norm(jacobian, axis=0)
    follows = is_free & (size > 0)
    determined = size > 0
    if follows.any():
        scaled = jacobian[:, follows] / size[follows]
        _, values, rows = np.linalg.svd(scaled, full_matrices=False)
        weak = rows[values < _NO_INFLUENCE * values[0]]
        determined[follows] &= ~(np.abs(weak) > _PART).any(axis=0)
    return np.asarray(determined)


def _noise(target: Target, otherwise: np.ndarray) -> np.ndarray:
    """Standard deviation by which each signal is weighted, (signals,)."""
    return np.array([target.noise.get(n, x) for n, x in zip(target.names, otherwise, strict=True)])


def rms_of(values: np.ndarray) -> np.ndarray:
    """Root mean square along the last axis; NaN values are skipped."""
    return np.asarray(np.sqrt(np.nanmean(values**2, axis=-1)))

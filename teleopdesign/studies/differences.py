"""Slopes of simulated signals in parameters, from differences of simulations side by side.

A slope is computed with five sizes of difference, each an eighth of the one before, and taken where
two neighbouring sizes agree best. A difference that is too large has an error from curvature. A
difference that is too small has an error from rounding. Where an encoder rounds, or motion sticks
and slips, jumps cause an error. There no two sizes agree; so the disagreement of the two sizes is
reported with each slope.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.errors import ModelError, TeleopDesignError, unknown
from ..diagrams.units import bounds_of_value
from .case import SimulatedCase
from .evaluate import group_alike, simulate_rows

#: steps of a numerical derivative over the scale of the parameter. At 10 % a step is longer than
#: the jumps of an encoder; at 2e-5 the curvature of smooth signals is 1e-9 of their slope, and
#: rounding (1e-13) is 1e-8 of it
SIZES = 0.1 * 8.0 ** -np.arange(5)
#: relative difference of two inner steps that counts as none
_SAME_STEP = 1e-9
#: the number of a computer on which simulated signals depend without jumps
_SMOOTH_IN_COMPUTER = "computer.velocity_bandwidth"


@dataclass(frozen=True, eq=False)
class SignalSlopes:
    """Signals and their slopes in parameters.

    time: (rows,), s;  signals: (signals, rows);  slopes: (parameters, signals, rows), SI
    apart: (parameters, signals) rms difference between the slopes of two sizes of difference, over
        the rms of the slope; 0 where the signal does not depend on the parameter, inf where no two
        slopes could be formed
    sizes: (parameters, signals) of the difference that is used, SI
    """

    time: np.ndarray
    signals: np.ndarray
    slopes: np.ndarray
    apart: np.ndarray
    sizes: np.ndarray


def check_slopes_exist(case: SimulatedCase, names: Sequence[str], signals: Sequence[str]) -> None:
    """Raise ModelError for an unknown signal, or for a parameter that changes signals by jumps."""
    case.check_names(names)
    setup = case.setup()
    known = setup.program.layout.columns
    for name in signals:
        if name not in known:
            raise ModelError(unknown("signal", name, known))
    for name in names:
        stem = name.partition(".")[0]
        of_simulation = name in ("duration", "step", "give")
        of_simulation |= stem == "computer" and name != _SMOOTH_IN_COMPUTER
        if of_simulation or name in setup.whole_step_delays:
            raise ModelError(
                f'"{name}" changes a simulation by jumps (whole steps, whole samples), so that no '
                "derivative exists: vary it in a `study`, or search it by `tune`"
            )
        if case.value(name) is None:
            raise ModelError(f'"{name}" is no number here')


def simulated_signals(
    case: SimulatedCase, names: Sequence[str], points: np.ndarray, signals: tuple[str, ...]
) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Time (rows,), signals (points, signals, rows), and why a point has none (NaN then).

    points: (points, names); all are simulated on the finest grid that one of them needs
    """
    table = {n: points[:, k] for k, n in enumerate(names)}
    time, rows, steps, reasons = _simulate(case, table, signals)
    finest = np.nanmin(steps) if np.isfinite(steps).any() else np.nan
    if np.nanmax(steps, initial=0.0) > finest * (1 + _SAME_STEP):
        case = replace(case, step=float(finest))
        time, rows, _, reasons = _simulate(case, table, signals)
    return time, rows, reasons


def _simulate(
    case: SimulatedCase, table: dict[str, np.ndarray], signals: tuple[str, ...]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[str]]:
    """Time, signals, steps (s) and reasons of failure for all rows of a table."""
    many = len(next(iter(table.values())))
    reasons, steps = [""] * many, np.full(many, np.nan)
    time: np.ndarray = np.zeros(0)
    parts: list[tuple[list[int], np.ndarray]] = []
    for rows, columns, others in group_alike(case, table):
        try:
            data = simulate_rows(case.with_values(others), columns, signals)
        except TeleopDesignError as error:
            for row in rows:
                reasons[row] = str(error)
            continue
        time = data["time"].values
        # without a value of the diagram that varies all rows are one and the same case
        cases = np.arange(len(rows)) if columns else np.zeros(len(rows), dtype=int)
        steps[rows] = data["step"].values[cases]
        for row, k in zip(rows, cases, strict=True):
            reasons[row] = str(data["reason"].values[k])
        parts.append((rows, np.stack([data[s].values[cases] for s in signals], axis=1)))
    values = np.full((many, len(signals), len(time)), np.nan)
    for rows, part in parts:
        values[rows] = part
    return time, values, steps, reasons


def slopes_of(
    case: SimulatedCase,
    names: Sequence[str],
    at: np.ndarray,
    scales: np.ndarray,
    signals: tuple[str, ...],
) -> SignalSlopes:
    """Slopes of the signals at some values of the parameters.

    at: (names,);  scales: (names,) above 0: a change is small if it is small beside its scale
    raises ModelError: the case has no simulation at `at`
    """
    offsets = np.stack([_offsets(case, n, x, s) for n, x, s in zip(names, at, scales, strict=True)])
    points = [np.asarray(at, dtype=float)]
    for k, row in enumerate(offsets):
        for offset in row.reshape(-1):
            point = points[0].copy()
            point[k] += offset
            points.append(point)
    time, values, reasons = simulated_signals(case, names, np.array(points), signals)
    if reasons[0]:
        raise ModelError(reasons[0])
    beside = values[1:].reshape(len(names), len(SIZES), 2, len(signals), len(time))
    ladder = _difference(values[0], beside, offsets[..., None, None])
    return SignalSlopes(time, values[0], *_find_best(ladder, np.abs(offsets).min(axis=2)))


def _offsets(case: SimulatedCase, name: str, value: float, scale: float) -> np.ndarray:
    """Two changes of a parameter for each size, (sizes, 2): to both sides if bounds allow."""
    lower, upper = -np.inf, np.inf
    if name in case.diagram.values:
        lower, upper = bounds_of_value(case.diagram, name)
    sizes = SIZES * scale
    towards = 1.0 if upper - value > value - lower else -1.0
    fits = (value - sizes > lower) & (value + sizes < upper)
    both, one = np.array([-1.0, 1.0]), towards * np.array([1.0, 2.0])
    return np.asarray(sizes[:, None] * np.where(fits[:, None], both, one))


def _difference(centre: np.ndarray, beside: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Slope at the centre of the parabola through the centre and two points beside it.

    centre: (signals, rows);  beside: (parameters, sizes, 2, signals, rows);  offsets: alike
    """
    a, b = offsets[:, :, 0], offsets[:, :, 1]
    first, second = (beside[:, :, 0] - centre) / a, (beside[:, :, 1] - centre) / b
    return np.asarray((first * b - second * a) / (b - a))


def _find_best(ladder: np.ndarray, sizes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slopes, their relative difference, and sizes, where two neighbouring sizes agree best.

    ladder: (parameters, sizes, signals, rows);  sizes: (parameters, sizes)
    """
    change = _rms(np.diff(ladder, axis=1))
    slope = _rms(ladder[:, 1:])
    change = np.where(np.isfinite(change), change, np.inf)
    best = np.argmin(change, axis=1)
    k, s = np.indices(best.shape)
    apart, size = change[k, best, s], slope[k, best, s]
    relative = np.where(apart == 0.0, 0.0, apart / np.where(size > 0, size, np.nan))
    relative = np.where(np.isnan(relative), np.inf, relative)
    slopes = np.where(np.isfinite(apart)[..., None], ladder[k, best + 1, s], 0.0)
    return slopes, relative, sizes[k, best + 1]


def _rms(values: np.ndarray) -> np.ndarray:
    return np.asarray(np.sqrt(np.mean(values**2, axis=-1)))

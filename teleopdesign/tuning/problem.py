"""Evaluation of the points of a search: first the limits, then simulations side by side.

Values scaled to 0..1 of their intervals, logarithmically where an interval is wide.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..base.errors import ModelError
from ..base.expectations import describe_value
from ..passivity.intervals.box import ValueBox
from ..studies.case import SimulatedCase
from ..studies.chosen_measures import Measure
from ..studies.evaluate import StudyTask, units_of
from ..studies.outcomes import PointOutcome
from ..studies.points import points_of
from ..studies.processes import run_on_this_machine
from ..studies.samples import Samples
from .limits import TuningLimit, margin_function

#: intervals whose ends differ by more than this factor are searched in logarithms
_WIDE = 9.9
#: a parameter is at an end of its interval if it is nearer than this share of the interval
AT_END = 0.01


def box_of_parameters(parameters: Mapping[str, tuple[float, float]]) -> ValueBox:
    """The intervals of the searched parameters.

    raises ModelError: no parameter, or no interval (low, high)
    """
    if not parameters:
        raise ModelError("parameters: found none, expected a name with (low, high)")
    for name, ends in parameters.items():
        if len(ends) != 2 or not all(map(np.isfinite, ends)) or not ends[0] < ends[1]:
            raise ModelError(
                f"parameters: {name}: found {describe_value(ends)}, expected (low, high)"
            )
    return ValueBox.of(parameters)


def unit_box(names: tuple[str, ...]) -> ValueBox:
    """The box of all shares."""
    return ValueBox(names, (0.0,) * len(names), (1.0,) * len(names))


def is_logarithmic(box: ValueBox) -> np.ndarray:
    """Mask (n,) of the parameters that are searched in logarithms."""
    low, high = np.array(box.low), np.array(box.high)
    return np.asarray((low > 0) & (high > _WIDE * low))


def values_at(box: ValueBox, shares: np.ndarray) -> np.ndarray:
    """Values at shares of the intervals, (..., n)."""
    low, high, logarithmic = np.array(box.low), np.array(box.high), is_logarithmic(box)
    safe = np.where(logarithmic, low, 1.0)
    ratio = np.where(logarithmic, high / safe, 1.0)
    share = np.clip(shares, 0, 1)
    inside = np.where(logarithmic, safe * ratio**share, low + share * (high - low))
    return np.asarray(np.clip(inside, low, high))


def shares_of(box: ValueBox, values: np.ndarray) -> np.ndarray:
    """Shares of the intervals at values, (n,)."""
    low, high, is_wide = np.array(box.low), np.array(box.high), is_logarithmic(box)
    safe, x = np.where(is_wide, low, 1.0), np.clip(values, low, high)
    logarithmic = np.log(np.where(is_wide, x, 1.0) / safe) / np.log(
        np.where(is_wide, high / safe, 2)
    )
    return np.asarray(np.where(is_wide, logarithmic, (x - low) / (high - low)))


def units_at(box: ValueBox, values: np.ndarray) -> np.ndarray:
    """Derivative of the values by their shares, (n,), SI."""
    low, high, logarithmic = np.array(box.low), np.array(box.high), is_logarithmic(box)
    ratio = np.where(logarithmic, high / np.where(logarithmic, low, 1.0), 1.0)
    return np.asarray(np.where(logarithmic, values * np.log(ratio), high - low))


#: most vertices of the intervals of a limit that the search evaluates, besides the middle
_MOST_VERTICES = 16
#: N s/m, 1 or 1/s: size of a margin that is rounding of zero
_ROUNDING = 1e-9
#: least margin of the best point, as a share of the spread of all margins of a claim, because the
#: last check is exact
_SLACK = 1e-6


@dataclass(frozen=True)
class TrialPoint:
    """A point that was evaluated.

    excesses: of every limit; < 0: violated, NaN: not evaluated
    objectives: NaN if not measured, because a limit was violated or the simulation failed
    """

    values: tuple[float, ...]
    excesses: tuple[float, ...]
    objectives: tuple[float, ...]

    @property
    def violation(self) -> float:
        """0 if every limit holds and all objectives are numbers; else above 0."""
        missed = [x for x in self.excesses if not x >= 0]
        if not missed and all(np.isfinite(self.objectives)):
            return 0.0
        sizes = [min(-x, 1e12) if np.isfinite(x) else 1e12 for x in missed if not np.isnan(x)]
        return float(sum(s / (1 + s) for s in sizes)) if sizes else 1.0


@dataclass
class Problem:
    """Parameters, objectives and limits of a search, and every point that was evaluated."""

    case: SimulatedCase
    parameters: ValueBox
    objectives: tuple[Measure, ...]
    limits: tuple[TuningLimit, ...]
    seed: int
    workers: int
    trials: dict[tuple[float, ...], TrialPoint] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    simulated: int = 0
    reason: str = ""

    def __post_init__(self) -> None:
        self.scenarios = [self._scenarios(one) for one in self.limits]
        self.margins = [self._margin(one) for one in self.limits]
        self.slack = [_SLACK] * len(self.limits)

    def tries(self, points: np.ndarray) -> list[TrialPoint]:
        """Evaluate each point once; points that satisfy the claims are simulated side by side."""
        keys = [tuple(map(float, p)) for p in points]
        new = [k for k in dict.fromkeys(keys) if k not in self.trials]
        excesses = {k: self._claims(k) for k in new}
        able = [k for k in new if all(x >= 0 for x in excesses[k] if not np.isnan(x))]
        measured = self._measure(able)
        for k in new:
            amounts = measured.get(k, {})
            objectives = tuple(amounts.get(m.name, np.nan) for m in self.objectives)
            kept = tuple(
                one.excess(amounts.get(one.measure.name, np.nan)) if one.measure and amounts else x
                for one, x in zip(self.limits, excesses[k], strict=True)
            )
            self.trials[k] = TrialPoint(k, kept, objectives)
        return [self.trials[k] for k in keys]

    def measured_at(
        self, values: tuple[float, ...], others: dict[str, float], one: TuningLimit
    ) -> float:
        """The measure of a limit at a point, with the values `others` in addition."""
        assert one.measure is not None
        return self._study([values], others, (one.measure,))[values].get(one.name, np.nan)

    def start_values(self) -> np.ndarray:
        """The case's values of the parameters, clipped to their intervals."""
        return start_values(self.case, self.parameters)

    def start(self) -> TrialPoint:
        """Evaluate the point of the case's values."""
        return self.tries(self.start_values()[None])[0]

    def within(self, values: Sequence[float]) -> SimulatedCase:
        """The case with these values of the parameters."""
        return self.case.with_values(self.parameters.named(np.array(values)))

    def best(self, key: Callable[[TrialPoint], float] | None = None) -> TrialPoint:
        """The point with the least objective within limits; else the least violation."""
        if kept := self.points_within_limits():
            return min(kept, key=key or (lambda t: t.objectives[0]))
        return min(self.trials.values(), key=lambda t: t.violation)

    def points_within_limits(self) -> list[TrialPoint]:
        """Points within all limits; only those that satisfy claims clearly, if there are any."""
        kept = [t for t in self.trials.values() if t.violation == 0]
        least = [
            share * self.spread(k) if one.measure is None else 0.0
            for k, (one, share) in enumerate(zip(self.limits, self.slack, strict=True))
        ]
        clear = [t for t in kept if all(x >= y for x, y in zip(t.excesses, least, strict=True))]
        return clear or kept

    def spread(self, k: int) -> float:
        """Largest minus smallest excess of the limit `k` over all points."""
        finite = [x for t in self.trials.values() if np.isfinite(x := t.excesses[k])]
        return max(finite) - min(finite) if finite else 0.0

    def _claims(self, key: tuple[float, ...]) -> tuple[float, ...]:
        """Least excess of each limit over its scenarios; NaN: a measure, or after a violation."""
        here = self.parameters.named(np.array(key))
        within = {n: v for n, v in here.items() if n in self.case.diagram.values}
        excesses = []
        failed = False
        for one, margin, points in zip(self.limits, self.margins, self.scenarios, strict=True):
            excess = np.nan
            if margin is not None and not failed:
                excess = min(one.excess(margin({**within, **point})) for point in points)
                # rounding of a margin that is zero: the last check is exact
                excess = max(excess, 0.0) if excess > -_ROUNDING else excess
                failed = excess < 0
            excesses.append(excess)
        return tuple(excesses)

    def _measure(
        self, keys: Sequence[tuple[float, ...]]
    ) -> dict[tuple[float, ...], dict[str, float]]:
        """Point -> measure -> number; for a limit on a measure, the worst over its scenarios."""
        amounts = self._study(list(keys), {}) if keys else {}
        for one, points in zip(self.limits, self.scenarios, strict=True):
            if one.measure is None or not one.over or not keys:
                continue
            worst = max if one.from_above else min
            for point in points:
                there = self._study(list(keys), point, (one.measure,))
                for k in keys:
                    values = [amounts[k].get(one.name, np.nan), there[k].get(one.name, np.nan)]
                    finite = not np.isnan(values).any()
                    amounts[k][one.name] = worst(values) if finite else np.nan
        return amounts

    def _study(
        self,
        keys: list[tuple[float, ...]],
        values: dict[str, float],
        measures: tuple[Measure, ...] = (),
    ) -> dict[tuple[float, ...], dict[str, float]]:
        """The measures at these points, with the values `values` in addition."""
        self.simulated += len(keys)
        limited = [one.measure for one in self.limits if one.measure is not None]
        listed = measures or tuple({m.name: m for m in (*self.objectives, *limited)}.values())
        names = self.parameters.names
        points = Samples(names, np.array(keys), ("",) * len(names), "random", self.seed)
        axes = points_of([points, values])
        task = StudyTask(self.case, self.case.settings(), axes, listed, self.seed)
        outcomes: dict[int, PointOutcome] = {}

        def keep(outcome: PointOutcome) -> None:
            outcomes[outcome.point] = outcome

        run_on_this_machine(task, units_of(task, range(len(keys))), keep, self.workers)
        return {k: self._numbers(outcomes[i]) for i, k in enumerate(keys)}

    def _numbers(self, outcome: PointOutcome) -> dict[str, float]:
        """Measure -> number at a point; empty if the point failed."""
        numbers = {}
        for (name, kind, unit, *_), value in zip(outcome.form, outcome.values, strict=True):
            if kind != "number" or isinstance(value, tuple):
                raise ModelError(f"{name}: found {describe_value(value)}, expected one number")
            self.units[name] = unit or self.units.get(name, "")
            numbers[name] = float(value)
        self.reason = outcome.reason or self.reason
        return numbers

    def _scenarios(self, one: TuningLimit) -> list[dict[str, float]]:
        if not one.over:
            return [{}]
        box = ValueBox.of(one.over)
        points = [*box.vertices()[:_MOST_VERTICES], box.centre]
        return [box.named(p) for p in points]

    def _margin(self, one: TuningLimit) -> Callable[[dict[str, float]], float] | None:
        """The margin of a claim or a loop as a function of values; None for a measure."""
        if one.measure is not None:
            return None
        diagram, every = self.case.diagram, self.parameters.intervals
        both = {n: ends for n, ends in every.items() if n in diagram.values}
        box = ValueBox.of(both | dict(one.over))
        return margin_function(one, diagram, box, self.case.computer)


def start_values(case: SimulatedCase, box: ValueBox) -> np.ndarray:
    """The case's values of the parameters (n,), clipped to their intervals."""
    listed = [case.value(n) for n in box.names]
    numbers = [np.nan if x is None else float(x) for x in listed]
    inside = np.where(np.isnan(numbers), box.centre, numbers)
    return np.asarray(np.clip(inside, box.low, box.high))

"""Last check of the limits at a tuned point, by the strictest method available."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..base.frozen import ByValue
from ..base.shown import Shown
from ..passivity.intervals.box import ValueBox, search_worst
from ..passivity.intervals.linear import CLAIMS
from ..passivity.intervals.over_box import claim_over_intervals
from .limits import LOOP_MARGINS, TuningLimit, loop_margin
from .problem import Problem, TrialPoint

#: points inside the intervals of a limit, beside vertices and middle
_POINTS = 32
#: a limit is active if its margin is below this share of the spread of margins in the search
_ACTIVE = 0.02


@dataclass(frozen=True, eq=False)
class CheckedLimit(Shown, ByValue):
    """A limit of a search, checked at the best point.

    value: the worst within the intervals of the limit;  worst: values at which it occurs
    how: method that shows the value
    active: whether the limit is kept and holds the search back: its value is near the bound
    """

    limit: TuningLimit
    value: float
    unit: str
    holds: bool
    how: str
    worst: Mapping[str, float] = field(default_factory=dict)
    active: bool = False


def recheck(problem: Problem, trial: TrialPoint) -> tuple[CheckedLimit, ...]:
    """Check every limit at a point."""
    return tuple(_check(problem, trial, k) for k in range(len(problem.limits)))


def _check(problem: Problem, trial: TrialPoint, k: int) -> CheckedLimit:
    one = problem.limits[k]
    diagram = problem.within(trial.values).diagram
    active = _is_active(problem, trial, k)
    if one.name in CLAIMS and one.measure is None:
        claim = claim_over_intervals(diagram, one.over, claim=one.name)
        proved = claim.status == "proved" and (one.bound <= 0 or claim.proved_margin >= one.bound)
        unmeasured = np.isnan(claim.margin)  # a claim without a margin shows that it is at least 0
        holds = bool(claim.holds) and (
            one.bound <= 0 if unmeasured else one.excess(claim.margin) >= 0
        )
        how = claim.known if one.over or not proved else f"proved at this point{claim.limited}"
        if unmeasured and not proved:
            how = f"without a margin: {claim.how}"
        elif holds and not proved:
            how = f"checked numerically at {claim.points} points, worst found there"
        active = active and holds
        return CheckedLimit(one, claim.margin, claim.unit, holds, how, claim.worst, active)
    box = ValueBox.of(one.over)

    def margin(point: np.ndarray) -> float:
        values = box.named(point)
        if one.name in LOOP_MARGINS and one.measure is None:
            here, computer = diagram.with_values(values), problem.case.computer
            return loop_margin(here, one.name, one.controller, computer)
        return one.excess(problem.measured_at(trial.values, values, one))

    worst = search_worst(margin, box, points=_POINTS if one.over else 0, seed=0, downhill=False)
    looped = one.name in LOOP_MARGINS and one.measure is None
    value = worst.margin if looped else _value(one, worst.margin)
    unit = one.unit or problem.units.get(one.name, "")
    how = f"checked numerically at {worst.points} points, worst found there"
    how = how if one.over else "computed at this point"
    holds = one.excess(value) >= 0
    active = active and holds
    return CheckedLimit(one, value, unit, holds, how, box.named(worst.point), active)


def _value(one: TuningLimit, excess: float) -> float:
    """The measure that has this excess."""
    return one.bound - excess if one.from_above else one.bound + excess


def _is_active(problem: Problem, trial: TrialPoint, k: int) -> bool:
    spread = problem.spread(k)
    return bool(trial.excesses[k] <= _ACTIVE * spread) if spread else False

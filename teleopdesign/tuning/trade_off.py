"""Trade-off of two measures: the points that no other point improves in both.

The second objective is bounded at several levels between the best values of the two objectives
(epsilon-constraint). At each level the first objective is minimised, as in `tune`. All evaluated
points count for the front.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..diagrams import Diagram
from ..simulate import Sampling, Trajectory
from ..simulate.sampling import SAMPLED
from ..studies.case import SimulatedCase, case_of
from .problem import Problem, TrialPoint
from .recheck import recheck
from .tune import Tuned, make_tuned, problem_of, search

if TYPE_CHECKING:
    import matplotlib.figure

#: share of all points for the search of the best value of each objective alone
_ENDS = 0.25


@dataclass(frozen=True, eq=False)
class ParetoFront(Shown, ByValue):
    """The best trade-offs between two measures, of which smaller values are better.

    points: each with its limits checked once more, by increasing first objective
    objectives: (k, 2) of the points;  before: (2,), with the diagram's values, NaN without a value
    evaluated: (m, 2), of all points within the limits;  evaluated_best: (j, 2), of the points that
        no other point beats in both; `points` are spread along them
    number: of evaluated points;  dropped: points whose limits failed in the last check
    """

    names: tuple[str, str]
    units: tuple[str, str]
    points: tuple[Tuned, ...]
    objectives: np.ndarray
    evaluated: np.ndarray
    evaluated_best: np.ndarray
    before: np.ndarray
    number: int
    dropped: int
    seed: int

    def plot(self) -> matplotlib.figure.Figure:
        """Plot both measures: the front as a line, all points within the limits in grey."""
        return figure_of(self)


@check_types
def trade_off(
    diagram: Diagram | SimulatedCase,
    parameters: Mapping[str, tuple[float, float]],
    objectives: Sequence[Any],
    *,
    subject_to: Sequence[Any] = (),
    duration: float = 0.0,
    inputs: Mapping[str, Any] | None = None,
    motion: Mapping[str, Trajectory] | None = None,
    initial: Mapping[str, float] | None = None,
    computer: Sampling | Literal["continuous"] = SAMPLED,
    step: float = 1e-4,
    points: int = 8,
    evaluations: int = 400,
    seed: int = 0,
    workers: int = 1,
) -> ParetoFront:
    """Search for the best trade-offs between two measures, within limits.

    Other arguments are those of `tune`.

    objectives: two measures;  points: largest number of points of the front
    evaluations: number of points that are evaluated in all
    raises ModelError: not two objectives, no point within the limits, and the errors of `tune`
    """
    if len(objectives) != 2:
        raise ModelError(f"trade_off: found {len(objectives)} objectives, expected two")
    case = case_of(
        diagram,
        duration=duration,
        inputs=inputs,
        motion=motion,
        initial=initial,
        computer=computer,
        step=step,
    )
    problem = problem_of(case, parameters, objectives, subject_to, seed, workers)
    before = problem.start()
    for number in (0, 1):
        search(problem, round(_ENDS * evaluations), number=number)
    kept = problem.points_within_limits()
    if not kept:
        raise ModelError(f"trade_off: none of {len(problem.trials)} points keeps all limits")
    at = np.array([t.objectives for t in kept])
    ends = at[at.argmin(axis=0), 1]
    inner = np.linspace(ends[0], ends[1], points)[1:-1]
    for level in inner:
        share = (1 - 2 * _ENDS) * evaluations / max(len(inner), 1)
        search(problem, max(1, round(share)), most=float(level))
    return _front(problem, before, points)


def _front(problem: Problem, before: TrialPoint, points: int) -> ParetoFront:
    kept = problem.points_within_limits()
    evaluated = np.array([t.objectives for t in kept])
    best = select_unbeaten(evaluated)
    chosen = _spread([kept[i] for i in best], points)
    results = []
    for trial in chosen:
        limits = recheck(problem, trial)
        results.append(make_tuned(problem, trial, before, limits))
    good = [(t, r) for t, r in zip(chosen, results, strict=True) if r.keeps_limits]
    first, second = (m.name for m in problem.objectives)
    return ParetoFront(
        (first, second),
        (problem.units.get(first, ""), problem.units.get(second, "")),
        tuple(r for _, r in good),
        np.array([t.objectives for t, _ in good]).reshape(-1, 2),
        evaluated,
        evaluated[best],
        np.array(before.objectives),
        len(problem.trials),
        len(chosen) - len(good),
        problem.seed,
    )


def select_unbeaten(objectives: np.ndarray) -> list[int]:
    """Rows of (m, 2) that no other row beats in both, by increasing first column."""
    front: list[int] = []
    lowest = np.inf
    for i in np.lexsort((objectives[:, 1], objectives[:, 0])):
        if objectives[i, 1] < lowest:
            lowest = float(objectives[i, 1])
            front.append(int(i))
    return front


def _spread(front: list[TrialPoint], points: int) -> list[TrialPoint]:
    """At most `points` of the points, evenly along the front, with both ends."""
    if len(front) <= points:
        return front
    at = np.array([t.objectives for t in front])
    size = np.ptp(at, axis=0)
    steps = np.hypot(*(np.diff(at, axis=0) / np.where(size > 0, size, 1.0)).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    wanted = np.linspace(0, along[-1], points)
    return [front[i] for i in dict.fromkeys(int(np.abs(along - w).argmin()) for w in wanted)]

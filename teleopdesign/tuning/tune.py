"""Search the values of a diagram for the smallest measure, within limits.

    td.tune(
        diagram,
        {"C.dahl.level": (0.1, 1.0), "H.gain.gain": (0.1, 10.0)},
        "force_error",
        subject_to=["passive", td.limit("delay margin", least=2e-3)],
        duration=1.0,
        motion={"L": td.sine(amplitude=0.01, frequency=1.0)},
    )

The search is differential evolution, because measures of simulations are neither smooth nor convex,
then a simplex from the best point. Points that violate a claim or a margin are not simulated. The
result is the best of the evaluated points. Its limits are checked once more, by the strictest
method.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown
from ..diagrams import Diagram
from ..simulate import Sampling, Trajectory
from ..simulate.sampling import SAMPLED
from ..studies.case import SimulatedCase, case_of
from ..studies.chosen_measures import measures_of, require_one_meaning
from .limits import limit_of
from .problem import AT_END, Problem, TrialPoint, box_of_parameters, shares_of, unit_box, values_at
from .recheck import CheckedLimit, recheck

#: most rounds: after each, the worst point of an interval that the search had not evaluated is
#: added
_ROUNDS = 3
#: factor on the least margin of the best point after the last check has refuted a claim
_FURTHER = 100.0
#: share of all points for the final simplex search
_POLISH = 0.25


@dataclass(frozen=True, eq=False)
class Tuned(Shown, ByValue):
    """The best point of a search.

    diagram: with `values`;  objective: the measure at this point;  before: the measure with the
        diagram's values (NaN if it was not measured there)
    limits: checked once more at `values`;  at_ends: parameters at an end of their interval
    number: of evaluated points;  simulated: number of simulations, or evaluations of measures
    """

    diagram: Diagram
    values: Mapping[str, float]
    name: str
    objective: float
    before: float
    unit: str
    limits: tuple[CheckedLimit, ...]
    at_ends: tuple[str, ...]
    number: int
    simulated: int
    seed: int

    @property
    def keeps_limits(self) -> bool:
        """Whether the point is within all limits, by the last check."""
        return np.isfinite(self.objective) and all(one.holds for one in self.limits)

    @property
    def active(self) -> tuple[str, ...]:
        """Limits that hold the search back."""
        return tuple(str(one.limit) for one in self.limits if one.active)


@check_types
def tune(
    diagram: Diagram | SimulatedCase,
    parameters: Mapping[str, tuple[float, float]],
    objective: Any,
    *,
    subject_to: Sequence[Any] = (),
    duration: float = 0.0,
    inputs: Mapping[str, Any] | None = None,
    motion: Mapping[str, Trajectory] | None = None,
    initial: Mapping[str, float] | None = None,
    computer: Sampling | Literal["continuous"] = SAMPLED,
    step: float = 1e-4,
    evaluations: int = 200,
    seed: int = 0,
    workers: int = 1,
) -> Tuned:
    """Search for the values with the least objective within all limits.

    parameters: names of `SimulatedCase` -> (low, high); in logarithms if high is 10 low or more
    objective: a measure, as in `study`: a name, `measure(...)`, or a function of the result
    subject_to: `limit(...)`, or names of claims ("passive", "absolutely stable", "stable")
    duration ... step: settings of the simulation, see `study`
    evaluations: points that are evaluated in one round; another round follows if a limit over
        intervals fails at a point of these intervals that the search had not evaluated
    seed: the same seed gives the same answer, for any number of `workers` (processes)
    returns: the best evaluated point, never "the optimum": other points may be better
    raises ModelError: an unknown parameter or measure, an invalid interval

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> loop = td.controller("gain", {"gain": 0.5})
        >>> best = td.tune(
        ...     td.haptic_interface(device, force_feedback=loop),
        ...     {"H.gain.gain": (0.1, 0.9)},
        ...     "force_error",
        ...     duration=0.2,
        ...     motion={"L": td.sine(amplitude=0.01, frequency=2.0)},
        ...     evaluations=10,
        ... )
        >>> sorted(best.values)
        ['H.gain.gain']
    """
    if isinstance(objective, list | tuple):
        raise ModelError(f"tune: found {len(objective)} objectives, expected one; see `trade_off`")
    case = case_of(
        diagram,
        duration=duration,
        inputs=inputs,
        motion=motion,
        initial=initial,
        computer=computer,
        step=step,
    )
    problem = problem_of(case, parameters, [objective], subject_to, seed, workers)
    start = problem.start()
    checked_limits = search_with_rounds(problem, evaluations)
    if not any(np.isfinite(t.objectives).all() for t in problem.trials.values()) and problem.reason:
        raise ModelError(f"tune: no point was measured: {problem.reason}")
    return make_tuned(problem, problem.best(), start, checked_limits)


def problem_of(
    case: SimulatedCase,
    parameters: Mapping[str, tuple[float, float]],
    objectives: Sequence[Any],
    subject_to: Sequence[Any],
    seed: int,
    workers: int,
) -> Problem:
    """The search for the given arguments; raises ModelError: arguments that do not fit the case."""
    case.check_names(parameters)
    box = box_of_parameters(parameters)
    measures = tuple(measures_of([one])[0] for one in objectives)
    limits = tuple(map(limit_of, subject_to))
    require_one_meaning([*measures, *(one.measure for one in limits if one.measure is not None)])
    for one in limits:
        if both := set(one.over) & set(parameters):
            raise ModelError(
                f"{min(both)}: is a parameter of the search, and also in the intervals of "
                f"{one.name}"
            )
        case.check_names(one.over)
    return Problem(case, box, measures, limits, seed, workers)


def search_with_rounds(problem: Problem, evaluations: int) -> tuple[CheckedLimit, ...]:
    """Search, check the best point, and continue if a limit fails at a new point."""
    for left in reversed(range(_ROUNDS)):
        if not problem.trials or left == _ROUNDS - 1:
            search(problem, evaluations)
        results = recheck(problem, problem.best())
        missed = [(k, one) for k, one in enumerate(results) if not one.holds]
        if problem.best().violation > 0 or not missed or not left:
            break
        new = [(k, dict(one.worst)) for k, one in missed if one.worst]
        new = [(k, point) for k, point in new if point not in problem.scenarios[k]]
        for k, point in new:
            problem.scenarios[k].append(point)
        if new:
            problem.trials.clear()  # all points are judged anew, at that point too
            continue
        for k, _ in missed:
            problem.slack[k] *= _FURTHER
    return results


def search(problem: Problem, evaluations: int, *, number: int = 0, most: float = np.inf) -> None:
    """Evaluate points by differential evolution, then by a simplex; the problem stores them.

    number: of the objective that is minimised;  most: upper bound of the other objective
    """
    from scipy.optimize import differential_evolution, minimize

    size = len(problem.parameters.names)
    population = max(8, 5 * size)
    scale = _Scale()

    def merit(points: np.ndarray) -> np.ndarray:
        trials = problem.tries(values_at(problem.parameters, points))
        return np.array([scale.merit(t, number, most) for t in trials])

    generations = max(1, round((1 - _POLISH) * evaluations / population) - 1)
    best = problem.best() if problem.trials else None
    evolve: Any = differential_evolution  # its types know no vectorised function
    evolved = evolve(
        lambda u: merit(u.T),
        [(0.0, 1.0)] * size,
        rng=np.random.default_rng(problem.seed),
        init=_first_generation(problem, population, best),
        maxiter=generations,
        vectorized=True,
        updating="deferred",
        polish=False,
        tol=1e-6,
    )
    minimize(  # type: ignore[call-overload]
        lambda u: float(merit(np.clip(u, 0, 1)[None])[0]),
        evolved.x,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * size,
        options={"maxfev": max(1, round(_POLISH * evaluations)), "xatol": 1e-4, "fatol": 1e-9},
    )


def _first_generation(problem: Problem, population: int, best: TrialPoint | None) -> np.ndarray:
    """Sobol points of the first generation, with the diagram's values and the best point so far."""
    points = unit_box(problem.parameters.names).inside(population, problem.seed)
    points[0] = shares_of(problem.parameters, problem.start_values())
    if best is not None:
        points[1] = shares_of(problem.parameters, np.array(best.values))
    return points


@dataclass
class _Scale:
    """One number for the search: below 1 if all limits hold, from 1 to 2 if not."""

    size: float = 0.0

    def merit(self, trial: TrialPoint, number: int, most: float) -> float:
        beyond = 0.0
        if np.isfinite(most) and trial.violation == 0:
            other = trial.objectives[1 - number]
            beyond = max(0.0, (other - most) / (abs(most) or 1.0))
        violation = trial.violation + beyond
        if violation > 0:
            return 1 + violation / (1 + violation)
        value = trial.objectives[0]
        self.size = self.size or abs(value) or 1.0
        return value / self.size / (1 + abs(value / self.size))


def make_tuned(
    problem: Problem,
    trial: TrialPoint,
    start: TrialPoint,
    limits: tuple[CheckedLimit, ...],
) -> Tuned:
    """The result of a search at a point."""
    share = shares_of(problem.parameters, np.array(trial.values))
    ends = [
        n for n, u in zip(problem.parameters.names, share, strict=True) if min(u, 1 - u) < AT_END
    ]
    name = problem.objectives[0].name
    return Tuned(
        problem.within(trial.values).diagram,
        problem.parameters.named(np.array(trial.values)),
        name,
        trial.objectives[0],
        start.objectives[0],
        problem.units.get(name, ""),
        limits,
        tuple(ends),
        len(problem.trials),
        problem.simulated,
        problem.seed,
    )

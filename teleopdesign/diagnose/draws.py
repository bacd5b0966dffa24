"""Start values of an effect whose hidden bodies part and meet, drawn over wide ranges.

With a wide gap one linear step promises nothing true: the tip meets the other side at other
moments, and the squares are rugged. So each draw is judged by the squares that it leaves itself,
with the parameters of the base at their linear best. The best draws are improved without
derivatives, and are then starts like others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..measurement.filtering import Array
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate, make_starts
from .cores import map_on_cores
from .fit import Fit, fit_squares
from .linear_start import Promises
from .search import Base, estimate_best_start, is_rugged
from .search_plan import PLAN
from .solve import free_parameters


def search_among_draws(
    attempts: Sequence[tuple[Candidate, Fit]],
    base: Base,
    prepared: Prepared,
) -> list[tuple[Candidate, Fit]]:
    """The attempts of a ranking; where none explains the records, gaps start from draws, too.

    An attempt is replaced by the fit from its draws if that leaves less, and if it drives no
    parameter of the base to a bound that the attempt keeps inside: it would be refused.
    """

    def order(fit: Fit) -> tuple[int, float]:
        return len(set(fit.at_bound) - set(base.fit.at_bound)), fit_squares(fit)

    def search(attempt: tuple[Candidate, Fit]) -> tuple[Candidate, Fit]:
        candidate, fit = attempt
        if not is_rugged(candidate.effect) or candidate.key in fit.model.absent:
            return attempt
        new = base.coarse.model.with_effect(candidate.effect, at=candidate.at)
        starts = best_draws(new, prepared.coarse, base.coarse)
        if not starts:
            return attempt
        best = estimate_best_start(starts, [candidate.key], prepared)
        return candidate, min((fit, best), key=order)

    return list(attempts) if explain_records(attempts, base) else map_on_cores(search, attempts)


def explain_records(attempts: Sequence[tuple[Candidate, Fit]], base: Base) -> bool:
    """Whether one of these candidates leaves so little that others need no further starts."""
    least = min((fit_squares(fit) for _, fit in attempts), default=math.inf)
    return least < PLAN.unexplained * fit_squares(base.fit)


def best_draws(model: Model, prepared: Prepared, base: Fit) -> list[Model]:
    """The best few starts of the absent effects of a model, among draws of their free parameters.

    returns: the best draws, and the values near them that leave less; none where no draw leaves
        less than the base, or no parameter is free
    base: the fit of the model without these effects, on the same samples
    """
    names, ranges = _ranges_of(model, prepared)
    if not names:
        return []
    promises = Promises(prepared, base)
    draws = []
    for i, point in enumerate(_spread_evenly(PLAN.draws, len(names))):
        x = ranges[0] + point * (ranges[1] - ranges[0])
        draws.append((promises.squares_beside(_with_logarithms(model, names, x)), i, x))
    best = sorted(draws, key=lambda draw: draw[:2])[: 2 * PLAN.followed]
    # of twelve wide gaps, the best draw left 15 to 71 % of the base's squares
    if not best[0][0] < fit_squares(base):
        return []
    improved = [_improve(model, names, x, promises) for _, _, x in best]
    return [*(_with_logarithms(model, names, x) for _, _, x in best), *improved]


def _ranges_of(model: Model, prepared: Prepared) -> tuple[list[str], tuple[Array, Array]]:
    """Names of the parameters to draw, and logarithms of their least and largest values.

    The ranges are those of the usual starts and beyond; of an essential parameter, such as the
    width of a gap, the upper half: the usual starts find small ones.
    """
    starts = make_starts(model, prepared.scales)
    free = set(free_parameters(starts[0]))
    least, most, names = [], [], []
    for effect, at in model.absent:
        for parameter, declared in model.body(at).effect(effect).parameters.items():
            name = f"{at}.{effect}.{parameter}"
            values = [s.parameters[name].value for s in starts]
            low, high = min(values), max(values)
            if name not in free or low <= 0.0:  # a zero has no logarithm
                continue
            low = math.sqrt(low * high) if declared.search.essential else low / PLAN.draws_beyond
            names.append(name)
            least.append(max(low, declared.lower))
            most.append(min(high * PLAN.draws_beyond, declared.upper))
    return names, (np.log(least), np.log(most))


def _spread_evenly(count: int, dimensions: int) -> Array:
    """Points (count, dimensions) of the unit cube, the same ones each time (Halton 1960)."""
    from scipy.stats import qmc  # takes a quarter of a second

    sequence = qmc.Halton(dimensions, scramble=False)
    sequence.fast_forward(1)
    return np.asarray(sequence.random(count))


def _with_logarithms(model: Model, names: Sequence[str], logarithms: Array) -> Model:
    """The model at these values, each within its bounds."""
    values = {}
    for name, value in zip(names, np.exp(logarithms).tolist(), strict=True):
        declared = model.declared(name)
        values[name] = min(max(value, declared.lower), declared.upper)
    return model.with_values(values)


def _improve(model: Model, names: Sequence[str], x: Array, promises: Promises) -> Model:
    """The model at the best values near a draw, by the simplex of Nelder and Mead (1965)."""
    from scipy.optimize import minimize  # takes half a second: imported only for a gap or a gear

    def left(logarithms: Array) -> float:
        return promises.squares_beside(_with_logarithms(model, names, logarithms))

    corners = np.vstack([x, x + PLAN.simplex * np.eye(len(x))])
    best = minimize(
        left,
        x,
        method="Nelder-Mead",
        bounds=None,
        options={"maxfev": PLAN.draw_evaluations, "initial_simplex": corners},
    )
    return _with_logarithms(model, names, np.asarray(best.x))

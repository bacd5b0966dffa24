"""The best fit of a model with new effects, from many starting values.

Each round keeps fewer starts. First one linear step is predicted from every start; if none promises
a gain, the search ends. Then a few real steps are made from the best starts, then rough fits. Only
the first ones of a ranking are fitted finely.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

from ..effects import Effect
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import make_starts
from .criteria import CRITERIA
from .fit import Fit, estimate, fit_of, fit_squares
from .least_squares import sum_of_squares
from .linear_start import (
    Promises,
    linear_starts,
    starts_at_values_of_user,
    with_hidden_states_anew,
    with_what_they_need,
    without_endless,
)
from .search_plan import EFFORTS, PLAN, Effort
from .solve import Solution, free_parameters, solve


@dataclass(frozen=True)
class Base:
    """The fitted model without its new effects.

    fit: on all samples;  coarse: on the few samples of `Prepared.coarse`, used for the search
    stated: the model as its user gave it; None: unknown, or no effect misleads the fit
    """

    fit: Fit
    coarse: Fit
    stated: Model | None = None

    def least(self, worth: float) -> float:
        """Sum of squares on few samples that a start must promise, or its gain is too small.

        worth: least gain over the base's squares, of few or of all samples, whichever are smaller:
            no effect can remove the additional error of few samples
        """
        few = fit_squares(self.coarse)
        return few - worth * min(few, fit_squares(self.fit))


def base_of(fit: Fit, prepared: Prepared, stated: Model | None = None) -> Base:
    """A fit, and the fit of the same model on few samples."""
    coarse = prepared.coarse
    if coarse is prepared:
        return Base(fit, fit, stated)
    there = solve(fit.model, coarse, EFFORTS.rough)
    p = len(fit.free)
    few = replace(
        fit,
        model=there.model,
        fit_residual=there.residual,
        jacobian=there.jacobian[:, :p],
        scale=there.scale[:p],
        by_shift=there.by_shift,
    )
    return Base(fit, few, stated)


def estimate_from_starts(
    model: Model,
    prepared: Prepared,
    base: Fit | Base | None = None,
    *,
    worth: float = CRITERIA.worth,
) -> Fit:
    """The best fit of a model, from every starting value of the effects that are still absent.

    Starts are followed on few samples; the best is estimated on all of them.

    base: a fit of the model without these effects; the best fit is then a rough one, for a ranking;
        None: it is a fine one
    worth: part of the base's squares that one linear step must promise to remove
    """
    coarse = prepared.coarse
    if isinstance(base, Fit):
        base = base_of(base, prepared)
    if base is not None:
        model = with_parameters_of(model, base.coarse.model)
    models, new = make_starts(model, prepared.scales), model.absent
    absent = [model.body(at).effect(name) for name, at in model.absent]
    wide = any(is_rugged(e) or len(e.parameters) > 2 * PLAN.followed for e in absent)
    kept = PLAN.wide if wide else PLAN.followed
    if base is not None:
        curved = strength_of_new(model) is None
        kept = kept if curved else 1
        if curved:
            models += starts_at_values_of_user(models, base.coarse, base.stated)
        most = PLAN.wide if wide else 2 * PLAN.followed
        others = with_what_they_need(model, models, prepared) if curved else []
        models = _select_promising(model, models, coarse, base, most=most, worth=worth)
        if others:
            models += _select_promising(model, others, coarse, base, most=most, worth=worth)
        if (freed := with_hidden_states_anew(model)) is not None:
            # far from the base, one linear step promises nothing, and orders the starts only
            others, kept = make_starts(freed, prepared.scales), PLAN.wide
            models += _select_promising(freed, others, coarse, base, most=kept, worth=-math.inf)
        if not models:
            return keep_absent(model, base.fit)
    elif len(models) == 1:
        return estimate(model, prepared)
    if len(models) > kept + 1:
        models = _best_stepped(models, coarse, kept, promised=base is not None)
    best = min((follow_start(m, coarse, EFFORTS.rough) for m in models), key=squares_of)
    if base is not None and squares_of(best) > fit_squares(base.coarse):
        best = from_smaller_strengths(model, models, best, coarse)
    if (less := without_endless(best, new)) is not best.model:
        anew = (follow_start(m, coarse, EFFORTS.rough) for m in make_starts(less, coarse.scales))
        best = min((best, *anew), key=squares_of)
    best = _sort_elements(best, coarse)
    if base is not None and coarse is prepared:
        return fit_of(best, prepared)
    return estimate(
        best.model, prepared, effort=EFFORTS.fine if base is None else EFFORTS.continued
    )


def estimate_best_start(
    models: Sequence[Model], new: Sequence[tuple[str, str]], prepared: Prepared
) -> Fit:
    """A rough fit from the best of these starts, which are followed on few samples.

    new: (effect, place) whose sum of squares has many local minima: better values are searched
        nearby
    """
    coarse = prepared.coarse
    best = min((follow_start(m, coarse, EFFORTS.rough) for m in models), key=squares_of)
    return estimate(_local_restart(best, new, coarse).model, prepared, effort=EFFORTS.continued)


def is_rugged(effect: Effect) -> bool:
    """Whether the squares of an effect have many local minima: its hidden bodies part and meet."""
    return bool(effect.corrections()) and not effect.linear


def _sort_elements(best: Solution, prepared: Prepared) -> Solution:
    """The solution with the parts of its effects in order, if this leaves no more.

    The order decides which parts must be determined, and which may be open.
    """
    model = best.model.in_order()
    if model is best.model:
        return best
    there = follow_start(model, prepared, EFFORTS.rough)
    return there if squares_of(there) <= (1.0 + PLAN.distinct_minimum) * squares_of(best) else best


def with_parameters_of(model: Model, other: Model) -> Model:
    """The model with the parameters and record shifts of a model that has some of its effects."""
    return model.with_values(dict(other.parameters)).with_record_shift(other.record_shift)


def from_smaller_strengths(
    model: Model, models: Sequence[Model], best: Solution, prepared: Prepared
) -> Solution:
    """The best solution from starts at parts of the strengths that one linear step gave.

    A search that leaves more than the model without the effect has gone astray, because this model
    is a special case: the strength was too large for the other values, which the step left behind.
    """
    linear = strength_of_new(model)
    if linear is None:
        return best
    strength = f"{linear[1]}.{linear[0].name}.{linear[0].strength}"
    starts = [
        m.with_values({strength: part * m.parameters[strength].value})
        for m in models
        for part in PLAN.smaller
    ]
    others = (follow_start(m, prepared, EFFORTS.rough) for m in starts)
    return min((best, *others), key=squares_of)


def follow_start(model: Model, prepared: Prepared, effort: Effort) -> Solution:
    """The rough optimum that a search from this start reaches."""
    return solve(model, prepared, effort)


def squares_of(solution: Solution) -> float:
    """Sum of squares that a solution leaves; inf where its motion grows beyond all numbers."""
    return sum_of_squares(solution.residual)


def strength_of_new(model: Model) -> tuple[Effect, str] | None:
    """The only absent effect and its place, if it has a strength that is free; else None."""
    absent = [(model.body(place).effect(name), place) for name, place in model.absent]
    if len(absent) != 1 or absent[0][0].strength is None:
        return None
    effect, place = absent[0]
    strength = f"{place}.{effect.name}.{effect.strength}"
    return absent[0] if not model.parameters[strength].fixed else None


def keep_absent(model: Model, base: Fit) -> Fit:
    """The fit of a model whose new effects stay absent: its residual is that of the base."""
    return replace(base, model=with_parameters_of(model, base.model))


def _select_promising(
    model: Model,
    models: list[Model],
    prepared: Prepared,
    base: Base,
    *,
    most: int,
    worth: float,
) -> list[Model]:
    """The starts from which one linear step promises most; none where none promises a gain.

    most: number of starts, for an effect that is linear in no strength
    """
    linear = strength_of_new(model)
    if linear is not None:
        return _start_by_strength(models, *linear, prepared, base, worth)
    promises = Promises(prepared, base.coarse)
    promised = sorted((promises.squares(m), i) for i, m in enumerate(models))
    if promised[0][0] > base.least(worth):
        return []
    return _vary_starts(model, [models[i] for _, i in promised])[:most]


def _vary_starts(model: Model, ordered: list[Model]) -> list[Model]:
    """The starts in another order: first one at each value of essential parameters.

    A search that starts with a gap that is too narrow closes it, and never opens it again.
    """
    essential = [
        f"{at}.{name}.{n}"
        for name, at in model.absent
        for n, p in model.body(at).effect(name).parameters.items()
        if p.search.essential
    ]
    first: dict[tuple[float, ...], Model] = {}
    rest = []
    for start in ordered:
        value = tuple(start.parameters[n].value for n in essential)
        if first.setdefault(value, start) is not start:
            rest.append(start)
    return [*first.values(), *rest]


def _start_by_strength(
    models: list[Model], effect: Effect, at: str, prepared: Prepared, base: Base, worth: float
) -> list[Model]:
    """The best starts of an effect that is linear in its strength; none if no gain is expected."""
    strength = f"{at}.{effect.name}.{effect.strength}"
    distinct: dict[tuple[float, ...], Model] = {}
    for model in models:
        others = {n: v.value for n, v in model.parameters.items() if n != strength}
        distinct.setdefault(tuple(others.values()), model)
    starts = linear_starts(list(distinct.values()), effect, at, prepared, base.coarse)
    if starts[0][0] > base.least(worth):
        return []
    return [start for _, start in starts[: PLAN.followed]]


def _best_stepped(
    models: list[Model], prepared: Prepared, kept: int, *, promised: bool
) -> list[Model]:
    """The best starts after a few steps of the fit, with the values that these steps reached.

    promised: whether the first start promised most; it is kept too, because after a few steps it
        may still leave more than a start that stays at the base
    """
    stepped = [follow_start(model, prepared, EFFORTS.first_steps) for model in models]
    order = sorted(range(len(models)), key=lambda i: squares_of(stepped[i]))
    best = order[:kept] + [i for i in order[kept:] if promised and i == 0]
    return [stepped[i].model for i in best]


def _local_restart(best: Solution, new: Sequence[tuple[str, str]], prepared: Prepared) -> Solution:
    """The best solution nearby, where the sum of squares has many shallow minima.

    new: (effect, place) whose parameters are changed by factors, one at a time
    """
    free = free_parameters(best.model)
    names = [n for effect, at in new for n in free if n.startswith(f"{at}.{effect}.")]
    model, least = best.model, squares_of(best)
    before = math.inf
    while least < (1.0 - PLAN.restart_gain) * before:
        before = least
        for name, factor in product(names, PLAN.restart_factors):
            moved = model.with_values({name: model.parameters[name].value * factor})
            solution = follow_start(moved, prepared, EFFORTS.first_steps)
            if squares_of(solution) < least:
                least, model = squares_of(solution), solution.model
    return best if model is best.model else follow_start(model, prepared, EFFORTS.rough)

"""Further starts of the search for new effects, where the usual ones mislead it."""

from __future__ import annotations

from collections.abc import Sequence

from ..effects import Effect
from ..measurement.prepare import Prepared
from ..model import Model
from .effort import EFFORTS, Effort
from .fit import free_parameters
from .least_squares import sum_of_squares
from .search_plan import PLAN
from .solve import Solution, solve


def with_what_they_need(model: Model, models: Sequence[Model], prepared: Prepared) -> list[Model]:
    """The same starts with strengths of the size of the force, where the new effects need others.

    Without the new effect, a fit may have taken the effect that it needs away: rigid friction does
    not describe a bristle in which most of the motion takes place, and its level falls to zero.
    """
    values: dict[str, float] = {}
    for name, at in model.absent:
        body = model.body(at)
        for needed in body.effect(name).needs:
            strength = body.effect(needed).strength if body.has(needed) else None
            full = f"{at}.{needed}.{strength}"
            # another effect of its role may stand in for it; a contact's needs no start
            value = model.parameters.get(full)
            if value is None or value.fixed:
                continue
            size = prepared.scales[model.declared(full).quantity]
            if value.value < PLAN.taken_away * size:
                values[full] = size
    return [m.with_values(values) for m in models] if values else []


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
    return solve(model, free_parameters(model), prepared, prepared.of("fit"), effort)


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

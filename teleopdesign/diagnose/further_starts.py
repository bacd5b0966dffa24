"""Further starts of a search, where a missing effect has led the model before it astray."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ..measurement.prepare import Prepared
from ..model import Model
from .fit import Fit
from .search_plan import PLAN
from .solve import Solution, spans_decades


def starts_at_values_of_user(
    models: Sequence[Model], base: Fit, stated: Model | None
) -> list[Model]:
    """The starts at the user's values; none where the base lies within users' usual errors.

    While an effect is missing, other parameters move to values from which no search returns: a
    heavy tip behind a gap ends at 38 % of the force, from the user's values at 6 %.
    """
    if stated is None:
        return []
    here, there = base.model.parameters, stated.parameters
    pairs = [(here[n].value, there[n].value) for n in base.free if n in there]
    if all(abs(value - before) <= PLAN.moved * abs(before) for value, before in pairs):
        return []
    values = {n: v.value for n, v in there.items() if n in models[0].parameters}
    return [m.with_values(values) for m in models]


def without_endless(best: Solution, new: Collection[tuple[str, str]]) -> Model:
    """The model of a solution, with the effects absent whose search ran to the end of its range.

    There an effect is another one, or none: the Stribeck law at an endless speed is one more
    Coulomb level. No search returns from there, because no residual depends on the parameter.

    new: (effect, place) that have begun at all of their starting values
    returns: the model itself where there is no such effect
    """
    model = best.model
    values: dict[str, float] = {}
    for name, at_bound in zip(best.free, best.at_bound[: len(best.free)], strict=True):
        at, effect, _ = (*name.split("."), "")[:3]
        if not at_bound or not spans_decades(model, name) or (effect, at) in new:
            continue
        law = model.body(at).effect(effect)
        absent = {f"{at}.{effect}.{n}": law.default(n) for n in law.parameters}
        if not any(model.parameters[n].fixed for n in absent):
            values |= absent
    return model.with_values(values) if values else model


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

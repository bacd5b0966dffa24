"""Further starts of a search, where a missing effect has led the model before it astray."""

from __future__ import annotations

from collections.abc import Sequence

from ..measurement.prepare import Prepared
from ..model import Model
from .fit import Fit
from .search_plan import PLAN


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

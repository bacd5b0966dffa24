"""Values that the user states: further start values of a search.

While an effect is missing, other parameters may move to values from which no search returns.
"""

from __future__ import annotations

from ..model import Model
from .fit import Fit
from .search_plan import PLAN


def reset_to_stated(model: Model, stated: Model, at: str | None = None) -> Model:
    """The model with its user's values, as a further start of a search.

    at: place whose body is reset; None: all bodies
    """
    there = model.parameters  # another effect may have replaced an effect of the user
    values = {n: v.value for n, v in stated.parameters.items() if n in there}
    if at is not None:
        values = {n: v for n, v in values.items() if model.locate(n)[0] == model.holder(at)}
    return model.with_values(values)


def has_moved(base: Fit, stated: Model) -> bool:
    """Whether the base moved a parameter further from the user's value than users' usual errors."""
    here, there = base.model.parameters, stated.parameters
    pairs = [(here[n].value, there[n].value) for n in base.free if n in there]
    return any(_is_far(value, before) for value, before in pairs)


def _is_far(value: float, stated: float) -> bool:
    return abs(value - stated) > PLAN.moved * abs(stated)


def is_at_stated(fit: Fit, stated: Model, at: str) -> bool:
    """Whether a fit is close to all stated values of one body, within users' usual errors.

    at: place on the body
    An effect stated without values counts as close only where its strength alone was estimated: the
    residual is linear in it, so there is no other minimum.
    """
    here, there, body = fit.model.parameters, stated.parameters, fit.model.holder(at)
    for name in fit.free:
        if name not in there or fit.model.locate(name)[0] != body:
            continue
        place, _, local_name = name.partition(".")
        effect, _, parameter = local_name.rpartition(".")
        if (effect, place) in stated.absent:
            estimated = [n for n in fit.free if n.startswith(f"{place}.{effect}.")]
            if stated.body(place).effect(effect).strength != parameter or len(estimated) > 1:
                return False
        elif _is_far(here[name].value, there[name].value):
            return False
    return True

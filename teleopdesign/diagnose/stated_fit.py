"""The fit of a model as its user states it, including effects that have no values yet."""

from __future__ import annotations

from ..base.errors import ModelError
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate
from .clock import with_late_starts, with_paying_shift
from .fit import Fit, estimate, fit_squares
from .rung import Replaced, restore_replaced
from .search import estimate_from_starts


def estimate_stated(model: Model, prepared: Prepared) -> Fit:
    """The best fit of a stated model with the shifts of its logs, as every ladder begins."""
    fit = with_late_starts(estimate_values(model, prepared), model, prepared)
    return with_paying_shift(fit, prepared)


def estimate_values(model: Model, prepared: Prepared) -> Fit:
    """The best fit of a stated model: all effects without values at once, or one at a time.

    An effect of several parameters may be misled while other effects are far from their values:
    bristles become rigid where Coulomb's level starts too low. Added to the fit of the other
    effects, it starts like a candidate.
    """
    together = estimate_from_starts(model, prepared)
    bare, missing = _take_out_absent(model)
    if not missing or len(model.absent) == 1:
        return together
    return min((together, _estimate_one_by_one(bare, missing, prepared)), key=fit_squares)


def _estimate_one_by_one(bare: Model, missing: list[Replaced], prepared: Prepared) -> Fit:
    """The fit after these effects were added in turn, each time the one that explains most."""
    fit = estimate_from_starts(bare, prepared)
    while missing:
        fits = {
            one.effect.key: estimate_from_starts(one.back_in(fit.model), prepared, fit, worth=0.0)
            for one in missing
            if not fit.model.body(one.effect.at).lacks(one.effect.effect)
        }
        best = min(fits, key=lambda key: fit_squares(fits[key]))
        fit, missing = fits[best], [one for one in missing if one.effect.key != best]
    return estimate(fit.model, prepared)


def _take_out_absent(model: Model) -> tuple[Model, list[Replaced]]:
    """The model without its absent effects of several parameters, and these effects.

    An absent effect stays where an effect with values needs it.
    """
    absent, rest = [], [Candidate(model.body(at).effect(n), at) for n, at in model.absent]
    rest = [one for one in rest if len(one.effect.parameters) > 1]
    whole = model
    for _ in range(len(rest)):  # an effect that another one needs is removed after it
        for one in list(rest):
            try:
                model = model.without_effect(one.effect.name, at=one.at)
            except ModelError:
                continue
            absent.append(restore_replaced(one, whole))
            rest.remove(one)
    return model, absent

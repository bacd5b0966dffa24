"""Rungs in order: the check error falls with each, and each is fitted without what comes later."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from ..errors import ModelError
from ..model import Model
from .candidates import Candidate
from .fit import Fit, estimate
from .prepare import Prepared
from .rank import ranked
from .ranking import Ranking
from .rung import Rung


def first_rise(rungs: Sequence[Rung]) -> int | None:
    """The first rung that leaves more on the check records than the one before it."""
    rises = (later.fit.check_error > rung.fit.check_error for rung, later in pairwise(rungs))
    return next((i for i, rises_here in enumerate(rises, 1) if rises_here), None)


def without_rise(rungs: Sequence[Rung]) -> tuple[Rung, ...]:
    """The rungs up to the first that leaves more than the one before it."""
    return tuple(rungs[: first_rise(rungs)])


def estimate_without(model: Model, candidate: Candidate, prepared: Prepared) -> Fit | None:
    """The fit of a model without one of its effects; None: another effect needs it."""
    name, at = candidate.key
    try:
        return estimate(model.without_effect(name, at=at), prepared)
    except ModelError:
        return None


def falling(rungs: Sequence[Rung], prepared: Prepared) -> tuple[Rung, ...] | None:
    """The rungs in an order in which the check error falls with each; None where none is found.

    A rung that leaves more than the one before it was masked by what follows it: the two change
    places.
    """
    order = tuple(rungs)
    for _ in rungs:
        rise = first_rise(order)
        if rise is None:
            return order
        if rise + 1 == len(order):
            return None
        masked, masking = order[rise], order[rise + 1]
        assert masked.added is not None and masking.added is not None
        before = order[rise - 1].fit
        alone = estimate_without(masking.fit.model, masked.added, prepared)
        if alone is None:
            return None
        first = Rung(masking.added, alone, _ranked_alone(before, masking.added, alone))
        second = Rung(masked.added, masking.fit, _ranked_alone(alone, masked.added, masking.fit))
        order = (*order[:rise], first, second, *order[rise + 2 :])
    return None


def _ranked_alone(base: Fit, candidate: Candidate, fit: Fit) -> Ranking:
    """The ranking of one candidate that was fitted already."""
    return Ranking(base, (ranked(base, candidate, fit),))


def refitted(rungs: Sequence[Rung], last: Fit, prepared: Prepared) -> tuple[Rung, ...]:
    """The rungs with each fit made again, from the values of the last, without what comes later."""
    backwards = [replace(rungs[-1], fit=last)]
    model = last.model
    for later, rung in zip(rungs[:0:-1], rungs[-2:0:-1], strict=False):
        assert later.added is not None
        model = model.without_effect(later.added.effect.name, at=later.added.at)
        backwards.append(replace(rung, fit=estimate(model, prepared)))
    return (rungs[0], *reversed(backwards))

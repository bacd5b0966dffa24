"""One step of a ladder of effects; and rungs in order: the check error falls with each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..blocks import Value
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate
from .fit import Fit, estimate
from .rank import make_ranked
from .ranking import Ranked, Ranking, name_of, named_instead
from .search import estimate_from_starts


@dataclass(frozen=True)
class Replaced:
    """An effect of the user's model that another effect replaced, with its parameters.

    values: (full name, value) of each parameter in the model before
    """

    effect: Candidate
    values: tuple[tuple[str, Value], ...]

    def back_in(self, model: Model) -> Model:
        """The model with the replaced effect and its earlier values."""
        whole = model.with_effect(self.effect.effect, at=self.effect.at)
        return whole.with_values(dict(self.values))


def make_replaced(ranked: Ranked, before: Model) -> Replaced | None:
    """The effect that a candidate replaces; None: it replaces none.

    before: the model that still has this effect
    """
    return None if ranked.instead_of is None else restore_replaced(ranked.instead_of, before)


def restore_replaced(effect: Candidate, before: Model) -> Replaced:
    """An effect to be replaced, with its parameters in the model before."""
    start = f"{effect.at}.{effect.effect.name}."
    values = tuple((n, v) for n, v in before.parameters.items() if n.startswith(start))
    return Replaced(effect, values)


@dataclass(frozen=True, eq=False, repr=False)
class Rung(ByValue):
    """One step of the ladder: the added effect, the fit, and the ranking.

    added: None: the rung of the user's model
    ranking: the candidates that were compared on this step
    alternatives: candidates that explain the records as well as the added one
    replaced: the effect of the user's model that the added one replaced
    could_be: other candidates that explain a good part of the same gain; stated where the model
        before left only noise, or the effect is not named
    """

    added: Candidate | None
    fit: Fit
    ranking: Ranking | None = None
    alternatives: tuple[Candidate, ...] = ()
    replaced: Replaced | None = None
    could_be: tuple[Candidate, ...] | None = None

    @property
    def instead_of(self) -> Candidate | None:
        """The effect of the user's model that the added effect replaced."""
        return None if self.replaced is None else self.replaced.effect

    @property
    def title(self) -> str:
        """The added effect in words, with the effect that it replaced."""
        return "" if self.added is None else named_instead(self.added, name_of(self.instead_of))

    def __repr__(self) -> str:
        return f"Rung {self.title or 'of the model'}: {self.fit!r}"


def undo_addition(model: Model, added: Candidate, replaced: Replaced | None) -> Model:
    """A model without an effect that was added, and with the effect that it replaced.

    raises ModelError: another effect of the model needs the added effect
    """
    name, at = added.key
    # the replaced effect returns first: an effect that needs one of the two always has one
    whole = model if replaced is None else replaced.back_in(model)
    if whole.body(at).has(name) or not model.body(at).has(name):
        return whole.without_effect(name, at=at)
    # a body has one effect of a kind: the effect that returned took the place of the added one
    return whole


def undo(rungs: Sequence[Rung], model: Model) -> Model | None:
    """A model without the effects of rungs, taken one after the other; None: one is needed."""
    try:
        for rung in rungs:
            assert rung.added is not None
            model = undo_addition(model, rung.added, rung.replaced)
    except ModelError:
        return None
    return model


def first_rise(rungs: Sequence[Rung]) -> int | None:
    """Index of the first rung with a larger check error than the rung before it; None: none has."""
    rises = (later.fit.check_error > rung.fit.check_error for rung, later in pairwise(rungs))
    return next((i for i, rises_here in enumerate(rises, 1) if rises_here), None)


def without_rise(rungs: Sequence[Rung]) -> tuple[Rung, ...]:
    """The rungs before the first one with a larger check error than its predecessor."""
    return tuple(rungs[: first_rise(rungs)])


def estimate_without(model: Model, rung: Rung, prepared: Prepared) -> Fit | None:
    """The fit of a model without a rung's effect; None: another effect needs this effect."""
    without = undo([rung], model)
    return None if without is None else estimate(without, prepared)


def order_by_falling_error(rungs: Sequence[Rung], prepared: Prepared) -> tuple[Rung, ...] | None:
    """The rungs in an order in which the check error falls with each; None where there is none.

    A rung with a larger error than its predecessor was masked by the rung after it: these two
    change places.
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
        alone = estimate_without(masking.fit.model, masked, prepared)
        if alone is None:
            return None
        first = Rung(
            masking.added,
            alone,
            ranking_alone(before, masking.added, alone, prepared, masking),
            masking.alternatives,
            replaced=masking.replaced,
        )
        second = Rung(
            masked.added,
            masking.fit,
            ranking_alone(alone, masked.added, masking.fit, prepared, masked),
            masked.alternatives,
            replaced=masked.replaced,
        )
        order = (*order[:rise], first, second, *order[rise + 2 :])
    return None


def ranking_alone(
    base: Fit,
    candidate: Candidate,
    fit: Fit,
    prepared: Prepared,
    rung: Rung | None = None,
) -> Ranking:
    """The ranking of one candidate that is already fitted, and of its look-alikes.

    rung: that of the candidate before, with the effect that it replaced and its look-alikes
    """
    instead_of = None if rung is None else rung.instead_of
    rank = partial(make_ranked, prepared=prepared, has_open_width=False)
    ranked = [rank(base, candidate, fit, instead_of=instead_of)]
    for other in () if rung is None else rung.alternatives:
        try:
            model = base.model.with_effect(other.effect, at=other.at)
        except ModelError:  # it is there already, or needs an effect that comes later
            continue
        best = estimate_from_starts(model, prepared, base, worth=0.0)
        ranked.append(rank(base, other, best))
    return Ranking(base, tuple(ranked))


def reorder_and_refit(
    rungs: Sequence[Rung], last: Fit, prepared: Prepared
) -> tuple[Rung, ...] | None:
    """The rungs in an order in which the check error falls, each fitted without later effects.

    last: the fit with all effects, whose values are the starts of the other fits
    returns: None where no order falls, or where an earlier effect needs a later one; the user's
        model alone is returned unchanged
    """
    if len(rungs) == 1:
        return tuple(rungs)
    backwards = [replace(rungs[-1], fit=last)]
    model: Model | None = last.model
    for later, rung in zip(rungs[:0:-1], rungs[-2:0:-1], strict=False):
        assert model is not None
        if (model := undo([later], model)) is None:
            return None
        backwards.append(replace(rung, fit=estimate(model, prepared)))
    return order_by_falling_error((rungs[0], *reversed(backwards)), prepared)

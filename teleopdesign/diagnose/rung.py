"""One step of a ladder of effects."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.frozen import ByValue
from ..blocks import Value
from ..model import Model
from .candidates import Candidate
from .fit import Fit
from .ranking import Ranked, Ranking, name_of, named_instead


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
    def errors(self) -> Fit:
        """The errors of the model; see `adequacy.Errors`."""
        return self.fit

    @property
    def instead_of(self) -> Candidate | None:
        """The effect of the user's model that the added effect replaced."""
        return None if self.replaced is None else self.replaced.effect

    @property
    def title(self) -> str:
        """The added effect in words, with the effect that it replaced."""
        return "" if self.added is None else named_instead(self.added, name_of(self.instead_of))

    def undo_addition(self, model: Model) -> Model:
        """A model without the effect that this rung added; see `undo_addition`."""
        assert self.added is not None
        return undo_addition(model, self.added, self.replaced)

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

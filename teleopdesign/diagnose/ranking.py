"""Ranked candidates, each with the fit by which it was compared."""

from __future__ import annotations

from dataclasses import dataclass

from ..base.frozen import ByValue
from ..base.shown import Shown
from .candidates import Candidate
from .fit import Fit

#: reasons for which an effect does not count, in words
REFUSALS = {
    "blind": "the command has no influence in more than a quarter of the motion",
    "hides": "explains no more of the command: the error is smaller only because less force acts",
}


def name_of(candidate: Candidate | None) -> str | None:
    """The name of a candidate's effect; None: there is no candidate."""
    return None if candidate is None else candidate.effect.name


def named_instead(candidate: Candidate, instead_of: str | None) -> str:
    """A candidate in words, with the name of the effect that it replaces, if any."""
    return str(candidate) + ("" if instead_of is None else f" instead of {instead_of}")


@dataclass(frozen=True, eq=False, repr=False)
class Ranked(ByValue):
    """A candidate, and the fit of the model that has this effect.

    score: how surely it lowers the error on the check records (standard deviations)
    behind: how surely the best candidate has the smaller error on all records; 0 for the best
    is_identifiable: whether its parameters are determined, beside those of the base
    refused: why it does not count although it may leave less force (a key of `REFUSALS`), or ""
    implausible: what its parameters stand for instead of its name, by its file or that of an effect
        beside it; ""
    instead_of: effect of the base that it makes superfluous, and that its model lacks; None
    """

    candidate: Candidate
    fit: Fit
    score: float
    behind: float
    is_identifiable: bool
    refused: str = ""
    implausible: str = ""
    instead_of: Candidate | None = None

    @property
    def counts(self) -> bool:
        """Whether the records can support it: identifiable, not refused and not implausible."""
        return self.is_identifiable and not self.refused and not self.implausible

    @property
    def title(self) -> str:
        """The candidate, with the effect that it replaces: "... at device instead of viscous"."""
        return named_instead(self.candidate, name_of(self.instead_of))

    @property
    def is_idle(self) -> bool:
        """Whether its fit ended at no strength: it gains nothing."""
        return self.candidate.key in self.fit.model.absent

    @property
    def note(self) -> str:
        """A remark for the table of candidates; "" for none."""
        if self.is_idle:
            return "gains nothing"
        if self.refused or self.implausible:
            return REFUSALS.get(self.refused, self.implausible)
        return "" if self.is_identifiable else "not determined"

    def __repr__(self) -> str:
        return f"Ranked {self.title}: score {self.score:.1f}, behind {self.behind:.1f}"


@dataclass(frozen=True, eq=False, repr=False)
class Ranking(Shown, ByValue):
    """Candidates, best first, and the fit that they are compared with.

    base: the model without any of them
    ranked: in the order of `order.rank_key`: those that count come first
    """

    base: Fit
    ranked: tuple[Ranked, ...]

    @property
    def best(self) -> Ranked:
        """The candidate with the smallest error."""
        return self.ranked[0]

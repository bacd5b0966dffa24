"""One step of a ladder of effects."""

from __future__ import annotations

from dataclasses import dataclass

from ..by_value import ByValue
from .candidates import Candidate
from .fit import Fit
from .ranking import Ranking


@dataclass(frozen=True, eq=False, repr=False)
class Rung(ByValue):
    """One step of the ladder: what was added (None: the user's model), the fit, and the ranking.

    ranking: the candidates that were compared on this step
    alternatives: those that explain the records as well as the added one
    """

    added: Candidate | None
    fit: Fit
    ranking: Ranking | None = None
    alternatives: tuple[Candidate, ...] = ()

    def __repr__(self) -> str:
        return f"Rung {self.added or 'of the model'}: {self.fit!r}"

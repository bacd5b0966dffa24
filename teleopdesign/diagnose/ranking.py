"""Candidates in order, with the fits that they were compared by."""

from __future__ import annotations

from dataclasses import dataclass

from ..by_value import ByValue
from ..notebook import html_table
from .candidates import Candidate
from .fit import Fit

#: reasons for which an effect does not count, in words
REFUSALS = {
    "blind": "the command has no influence in more than a quarter of the motion",
    "weak": "the actuator could not give what the model needs to slide",
    "hides": "explains no more of the command: less force acts, and so less is left",
}


@dataclass(frozen=True, eq=False, repr=False)
class Ranked(ByValue):
    """A candidate with the model fitted with it.

    score: how surely it lowers the error on the check records (standard deviations)
    behind: how surely the best candidate has the smaller error on all records; 0 for the best
    is_identifiable: its parameters are determined, and told from those of the model it was added to
    refused: why it does not count though it may leave less force (a key of `REFUSALS`), or ""
    """

    candidate: Candidate
    fit: Fit
    score: float
    behind: float
    is_identifiable: bool
    refused: str = ""

    @property
    def counts(self) -> bool:
        """Whether the candidate is identifiable and not refused."""
        return self.is_identifiable and not self.refused

    @property
    def note(self) -> str:
        """A remark beside the numbers; "" for none."""
        if self.candidate.key in self.fit.model.absent:
            return "gains nothing"
        return REFUSALS.get(self.refused, "" if self.is_identifiable else "not determined")

    def __repr__(self) -> str:
        return f"Ranked {self.candidate}: score {self.score:.1f}, behind {self.behind:.1f}"


@dataclass(frozen=True, eq=False)
class Ranking(ByValue):
    """Candidates, best first, and the fit that they are compared with."""

    base: Fit
    ranked: tuple[Ranked, ...]

    @property
    def best(self) -> Ranked:
        """The candidate with the smallest error."""
        return self.ranked[0]

    def _repr_html_(self) -> str:
        base = (f"{self.base.fit_error:.4f}", f"{self.base.check_error:.4f}")
        rows: list[tuple[str, ...]] = [("(the model)", *base, "", "", "")]
        for r in self.ranked:
            errors = (f"{r.fit.fit_error:.4f}", f"{r.fit.check_error:.4f}")
            rows.append((str(r.candidate), *errors, f"{r.score:.1f}", f"{r.behind:.1f}", r.note))
        head = ("candidate", "fit error", "check error", "score", "behind", "")
        return html_table("Candidates, best first", head, rows)

    def __repr__(self) -> str:
        lines = [f"{'candidate':<40}{'fit error':>10}{'check error':>13}{'score':>8}{'behind':>8}"]
        lines.append(
            f"{'(the model)':<40}{self.base.fit_error:>10.4f}{self.base.check_error:>13.4f}"
        )
        for r in self.ranked:
            note = f"  {r.note}" if r.note else ""
            lines.append(
                f"{r.candidate!s:<40}{r.fit.fit_error:>10.4f}{r.fit.check_error:>13.4f}{r.score:>8.1f}{r.behind:>8.1f}{note}"
            )
        return "\n".join(lines)

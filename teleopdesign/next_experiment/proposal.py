"""The proposal: the next motion, the reason for it, what it will show, and what it cannot show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ..base.finding import Finding
from ..base.frozen import ByValue
from ..diagnose.diagnosis import Diagnosis
from ..measurement.filtering import Array
from .limits import Limits
from .prediction import DECIDES, SAME, Curves, DeterminedParameter, Separation
from .remedies import Remedy
from .rivals import Rival
from .synthesis import Bench, PlannedMotion
from .words import proposal_findings, proposal_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Reference(ByValue):
    """Positions for the servos of the bodies (SI).

    time: s, (n,), uniform with the record's sample time;  position: body -> (n,)
    parts: clauses on the motion, in their order;  repeats: of all parts together
    """

    time: Array
    position: Mapping[str, Array]
    parts: tuple[str, ...]
    repeats: int

    @property
    def duration(self) -> float:
        """Length, s."""
        return float(self.time[-1])


@dataclass(frozen=True, eq=False)
class Proposal(ByValue):
    """The motion to measure next, which separates the rivals.

    rivals: models that the present records leave open; empty where the records decide
    reference: the motion; None where there are no rivals, or no motion keeps the limits
    sentence: the motion and its expected result, in words
    separations: one for each truth and each of its rivals
    determined: parameters that become determinable
    remedies: pair of rivals (numbers) that the motion does not separate -> simulated changes
    limits: body -> limits that the motion keeps
    bench, plan: for simulated records of the motion (`in_simulation`)
    """

    diagnosis: Diagnosis
    rivals: tuple[Rival, ...]
    reference: Reference | None
    sentence: str
    separations: tuple[Separation, ...]
    determined: tuple[DeterminedParameter, ...]
    curves: tuple[Curves, ...]
    remedies: Mapping[tuple[int, int], tuple[Remedy, ...]]
    limits: Mapping[str, Limits]
    bench: Bench = field(repr=False)
    plan: PlannedMotion | None = field(default=None, repr=False)

    def decides(self, pair: tuple[int, int]) -> bool:
        """Whether the motion separates two rivals, whichever of them is the truth."""
        a, b = (self.rivals[i] for i in pair)
        both = [s for s in self.separations if {id(s.truth), id(s.other)} == {id(a), id(b)}]
        return len(both) == 2 and all(s.predicted >= DECIDES for s in both)

    @property
    def is_useful(self) -> bool:
        """Whether the motion separates any two rivals better than the present records do."""
        return any(s.predicted > max(s.present, SAME) for s in self.separations)

    def __repr__(self) -> str:
        return proposal_text(self)

    def findings(self) -> tuple[Finding, ...]:
        """The proposal as findings for a report."""
        return proposal_findings(self)

    def plot(self) -> Figure:
        """Figure of the motion, the residual of a wrong model along it, and the separations."""
        from ..show.figures.next_experiment import plot_proposal

        return plot_proposal(self)

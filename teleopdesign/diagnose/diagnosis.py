"""What a recording says about a model: the ladder of effects, and the verdict on it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..by_value import ByValue
from ..measurement.experiment import Experiment
from ..model import Model
from ..notebook import html_table
from .candidates import Candidate
from .fit import Fit
from .force_error import Prepared
from .noise_floor import NoiseFloor
from .one_moment import Moment, worst_moment
from .rank import BLIND, Ranking

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: what is left counts as noise up to this many noise floors
ADEQUATE = 1.8
#: what is named must explain this part of the squares above the noise floor
MOSTLY = 0.5


@dataclass(frozen=True, eq=False, repr=False)
class Rung(ByValue):
    """One step of the ladder: what was added (None: the user's model), the fit, and the ranking.

    ranking: the candidates that were compared on this step; equals: those as good as the added one
    """

    added: Candidate | None
    fit: Fit
    ranking: Ranking | None = None
    equals: tuple[Candidate, ...] = ()

    def __repr__(self) -> str:
        return f"Rung {self.added or 'of the model'}: {self.fit!r}"


@dataclass(frozen=True, eq=False)
class OpenQuestion(ByValue):
    """An accepted effect and what may stand in its place as well; None: nothing was accepted.

    others: each with the fit that it was compared by
    """

    added: Candidate | None
    others: tuple[tuple[Candidate, Fit], ...]


@dataclass(frozen=True, eq=False)
class Diagnosis(ByValue):
    """What a recording says about a model.

    verdict: "effects_missing", "model_adequate" or "undecided"
    rungs: the user's model re-estimated, then one rung an effect
    last: ranking after the last rung, none of which was accepted
    estimated: the last rung's fit before what its readings do was taken off: to be held against
        other fits
    moment: the one moment that holds all that is left above noise; None where there is none
    open: what the records leave open, of a diagnosis that was read back: it has no rankings
    named: accepted effects that are probable enough to be said missing
    """

    experiment: Experiment
    prepared: Prepared
    verdict: str
    rungs: tuple[Rung, ...]
    last: Ranking
    estimated: Fit
    floor: NoiseFloor
    moment: Moment | None = None
    open: tuple[OpenQuestion, ...] | None = None
    named: tuple[Candidate, ...] = ()

    @property
    def before(self) -> Fit:
        """The user's model, re-estimated."""
        return self.rungs[0].fit

    @property
    def after(self) -> Fit:
        """The model with every accepted effect."""
        return self.rungs[-1].fit

    @property
    def model(self) -> Model:
        """The model that the diagnosis ends with."""
        return self.after.model

    @property
    def missing(self) -> tuple[Candidate, ...]:
        """Effects that can be named, in the order added; none where the verdict is undecided."""
        return self.named if self.verdict == "effects_missing" else ()

    @property
    def unlikely(self) -> bool:
        """Whether it is undecided only since no effect that explains most is probable enough."""
        decided = verdict(self.rungs, self.floor, self.moment) == "effects_missing"
        return self.verdict == "undecided" and decided

    @property
    def groups(self) -> tuple[tuple[Candidate, ...], ...]:
        """Effects that explain the records equally well, named one first."""
        return tuple((r.added, *r.equals) for r in self.rungs if r.added is not None and r.equals)

    @property
    def more_is_missing(self) -> bool:
        """Whether more than noise is left."""
        return not is_adequate(self.after, self.floor) and self.moment is None

    @property
    def left(self) -> float:
        """Error that is left, in noise floors: of the force or seen at the command, the larger."""
        return floors_left(self.after, self.floor)

    def plot(self) -> Figure:
        """The figure: forces, residual over time, velocity and position, ladder (a Figure)."""
        from ..plot.diagnosis import plot_diagnosis

        return plot_diagnosis(self)

    def _repr_html_(self) -> str:
        from .answer import sentence

        rows = [
            (
                "(your model, re-estimated)" if r.added is None else f"+ {r.added}",
                f"{100 * r.fit.fit_error:.2f} %",
                f"{100 * r.fit.check_error:.2f} %",
            )
            for r in self.rungs
        ]
        rows.append(("noise floor", "", f"{100 * self.floor.value:.2f} %"))
        head = ("added", "fit error", "check error")
        return html_table("Diagnosis", head, rows, note=sentence(self))

    def __repr__(self) -> str:
        from .answer import ladder_text

        return ladder_text(self)


def floors_left(found: Fit, floor: NoiseFloor) -> float:
    """Error that a model leaves on the check records, in noise floors, seen at the command too."""
    if not (floor.value and math.isfinite(found.seen.error)):
        return float("inf")
    return max(found.check_error / floor.value, found.seen.error / floor.seen)


def is_noise(check_error: float, floor: NoiseFloor) -> bool:
    """Whether so large an error on the check records counts as noise."""
    return check_error <= ADEQUATE * floor.value


def is_adequate(found: Fit, floor: NoiseFloor) -> bool:
    """Whether what a model leaves on the check records counts as noise, seen at the command too.

    A model that is blind in much of the motion says too little to be adequate.
    """
    at_command = found.seen.error <= ADEQUATE * floor.seen and found.seen.blind <= BLIND
    return is_noise(found.check_error, floor) and at_command


def moment_above_noise(found: Fit, prepared: Prepared, floor: NoiseFloor) -> Moment | None:
    """The one moment that holds all that a model leaves above noise; None where none does."""
    if is_adequate(found, floor):
        return None
    moment = worst_moment(found, prepared, floor)
    return moment if moment is not None and moment.without <= ADEQUATE else None


def explained(before: Fit, after: Fit, floor: NoiseFloor) -> float:
    """Part of the squares above the noise floor that the effects between the two explain.

    Of the force or seen at the command, the smaller part.
    """
    of_force = _taken_away(before.check_error, after.check_error, floor.value)
    return min(of_force, _taken_away(before.seen.error, after.seen.error, floor.seen))


def _taken_away(before: float, after: float, floor: float) -> float:
    return (before**2 - after**2) / max(before**2 - floor**2, 1e-300)


def verdict(rungs: Sequence[Rung], floor: NoiseFloor, moment: Moment | None = None) -> str:
    """ "effects_missing", "model_adequate" or "undecided".

    moment: as `moment_above_noise` says; what is left at one moment only is no missing physics
    """
    added = [r for r in rungs if r.added is not None]
    if not added:
        adequate = is_adequate(rungs[-1].fit, floor) or moment is not None
        return "model_adequate" if adequate else "undecided"
    if explained(rungs[0].fit, rungs[-1].fit, floor) < MOSTLY or all(r.equals for r in added):
        return "undecided"
    return "effects_missing"

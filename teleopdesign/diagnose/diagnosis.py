"""The result of a diagnosis: the ladder of effects, and the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..by_value import ByValue
from ..measurement.experiment import Experiment
from ..model import Model
from .adequacy import floors_left, is_adequate
from .candidates import Candidate, list_look_alikes
from .decision import verdict
from .fit import Fit
from .ladder_text import ladder_html, ladder_text, sentence
from .learnable import Learnable, NearReversals
from .noise_floor import NoiseFloor
from .one_moment import Moment
from .prepare import Prepared
from .ranking import Ranking
from .rung import Rung

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class OpenQuestion(ByValue):
    """An accepted effect (None: none was accepted) and the rivals that could replace it.

    others: each with the fit that it was compared by
    """

    added: Candidate | None
    others: tuple[tuple[Candidate, Fit], ...]


@dataclass(frozen=True)
class Untold:
    """A sentence on parameters of an accepted effect that the records do not determine."""

    candidate: Candidate
    sentence: str

    def __str__(self) -> str:
        return f"{self.candidate}: {self.sentence}"


@dataclass(frozen=True)
class SetAside:
    """An effect that lowered the error and was removed again, with its error and the reason."""

    candidate: Candidate
    check_error: float
    reason: str

    def __str__(self) -> str:
        return f"{self.candidate} ({100 * self.check_error:.2f} %): {self.reason}"


@dataclass(frozen=True, eq=False)
class Diagnosis(ByValue):
    """Result of a diagnosis: the ladder of effects, its fits, and the verdict.

    verdict: "effects_missing", "model_adequate" or "undecided"
    rungs: the user's model re-estimated, then one rung an effect
    last: ranking after the last rung, none of which was accepted
    estimated: the last rung's fit, parameters not yet corrected for errors of the readings; use it
        where fits are compared with each other
    floor: the noise floor: the error that the sensors alone would leave
    moment: the single time span that holds all of the residual above noise; None: there is no such
        span
    open: questions that the records leave open; stated for a diagnosis that was read from a file,
        which has no rankings
    named: accepted effects that are probable enough to be called missing
    learnable: how much of the residual a black box can learn; None without the extra `learn`
    near_reversals: the check error near reversals of the motion; None where there are none
    left_out: what a full search includes and this one did not, in words
    untold: what the records cannot tell of the accepted effects
    set_aside: effects that were accepted first and removed again: with the errors that the answer
        states, they are not there
    on_all_records: check error of the final model estimated on all records; None: it was not
        asked, for the check records leave no more than the fit records do
    sensor_floor: what the sensors alone leave, by which effects are believed; None: the floor.
        Where a command's scatter is noise too (`between_rows`), effects may stand in for it
    recorded: the answer file that the diagnosis was read from, with its candidates; else None
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
    learnable: Learnable | None = None
    near_reversals: NearReversals | None = None
    left_out: tuple[str, ...] = ()
    untold: tuple[Untold, ...] = ()
    set_aside: tuple[SetAside, ...] = ()
    on_all_records: float | None = None
    sensor_floor: NoiseFloor | None = None
    recorded: Mapping[str, Any] | None = None

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

    def reason_set_aside(self, key: tuple[str, str]) -> str:
        """Why an effect (name, place) that was accepted once is not there; "" for all others."""
        return next((one.reason for one in self.set_aside if one.candidate.key == key), "")

    @property
    def unlikely(self) -> bool:
        """Whether the verdict is undecided only because no effect is probable enough."""
        decided = verdict(self.rungs, self.floor, self.moment) == "effects_missing"
        return self.verdict == "undecided" and decided

    @property
    def groups(self) -> tuple[tuple[Candidate, ...], ...]:
        """Effects that explain the records equally well, named one first."""
        return tuple(
            (r.added, *r.alternatives) for r in self.rungs if r.added is not None and r.alternatives
        )

    @property
    def look_alikes(self) -> tuple[tuple[Candidate, Candidate], ...]:
        """Accepted effects, each with one that gives nearly the same force over this travel.

        Named nonetheless: by an effect's file one of the two is the commoner (`Effect.commoner`).
        """
        if self.prepared.is_of_an_arm:  # its links have gravity
            return ()
        doubted = dict.fromkeys(one.candidate for one in self.untold)
        return tuple((one, other) for one in doubted for other in list_look_alikes(one, self.model))

    @property
    def more_is_missing(self) -> bool:
        """Whether the final model leaves more than noise."""
        return not is_adequate(self.after, self.floor) and self.moment is None

    @property
    def may_be_noise(self) -> bool:
        """Whether all that is left may be noise, for by the final model sensors leave as much.

        The floor that counts was held below that, so that nothing hides in it.
        """
        drawn = replace(self.floor, value=self.floor.drawn)
        return self.more_is_missing and self.floor.held and is_adequate(self.after, drawn)

    @property
    def floor_of_belief(self) -> NoiseFloor:
        """The noise floor by which effects are believed."""
        return self.floor if self.sensor_floor is None else self.sensor_floor

    @property
    def left(self) -> float:
        """Final error in noise floors: of the force or at the command, the larger."""
        return floors_left(self.after, self.floor)

    def plot(self) -> Figure:
        """The figure: forces, residual over time, velocity and position, ladder (a Figure)."""
        from ..plot.diagnosis import plot_diagnosis

        return plot_diagnosis(self)

    def _repr_html_(self) -> str:
        return ladder_html(self.rungs, floor=self.floor.value, note=sentence(self))

    def __repr__(self) -> str:
        return ladder_text(self)

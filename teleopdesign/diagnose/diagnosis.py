"""The result of a diagnosis: the ladder of effects, and the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..base.frozen import ByValue
from ..base.shown import figure_of
from ..check import why_silent
from ..measurement.experiment import Experiment
from ..measurement.prepare import Prepared
from ..model import Model
from .adequacy import floors_left, is_adequate
from .candidates import Candidate, list_look_alikes
from .decision import verdict
from .fit import Fit
from .ladder_text import ladder_html, ladder_text, sentence
from .learnable import Learnable, NearReversals
from .noise_floor import NoiseFloor
from .one_moment import Moment
from .ranking import Ranking
from .repeats import Repeatability
from .rung import Rung

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class OpenQuestion(ByValue):
    """An accepted effect and its rivals that the records cannot exclude.

    added: the accepted effect; None: none was accepted
    others: each rival with the fit that it was compared by
    """

    added: Candidate | None
    others: tuple[tuple[Candidate, Fit], ...]


@dataclass(frozen=True)
class Undetermined:
    """A sentence on parameters of an accepted effect that the records do not determine."""

    candidate: Candidate
    sentence: str

    def __str__(self) -> str:
        return f"{self.candidate}: {self.sentence}"


@dataclass(frozen=True)
class SetAside:
    """An effect that lowered the error and was removed again, with its error and the reason.

    of_readings: whether the effect only weakens errors of the readings: its own error then does not
        limit the noise floor of the model without it
    """

    candidate: Candidate
    check_error: float
    reason: str
    of_readings: bool = False

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
    open: questions that the records leave open, where they are stored: in a diagnosis read from a
        file, or of an arm's joint; None: they follow from the rankings
    named: accepted effects that are probable enough to be called missing
    learnable: how much of the residual a black box can learn; None without the extra `learn`
    near_reversals: the check error near reversals of the motion; None where there are none
    repeats: how far the residual repeats with the motion; None where no motion is repeated
    left_out: parts of a full search that this one left out, in words
    undetermined: what the records cannot determine about the accepted effects
    set_aside: effects that were accepted first and removed again, because the final errors do not
        support them
    on_all_records: check error of the final model estimated on all records; None: not computed,
        because the check error is not much larger than the fit error
    sensor_floor: error that the sensors alone leave, used for the probability of effects; None:
        equal to the floor. Where the scatter of a command is noise too (`between_rows`), an effect
        may imitate it
    recorded: content of the answer file that the diagnosis was read from; else None
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
    repeats: Repeatability | None = None
    left_out: tuple[str, ...] = ()
    undetermined: tuple[Undetermined, ...] = ()
    set_aside: tuple[SetAside, ...] = ()
    on_all_records: float | None = None
    sensor_floor: NoiseFloor | None = None
    recorded: Mapping[str, Any] | None = None

    @property
    def before(self) -> Fit:
        """The fit of the user's model, re-estimated."""
        return self.rungs[0].fit

    @property
    def after(self) -> Fit:
        """The fit of the model with every accepted effect."""
        return self.rungs[-1].fit

    @property
    def model(self) -> Model:
        """The final model of the diagnosis."""
        return self.after.model

    @property
    def missing(self) -> tuple[Candidate, ...]:
        """Effects that are called missing, in the order added; none where they cannot be named."""
        return self.named if self.verdict == "effects_missing" else ()

    @property
    def why_silent(self) -> str:
        """Why the records tell no effect, so that none was a candidate; "": they may tell one."""
        return why_silent(self.prepared, self.rungs[0].fit.model)

    def reason_set_aside(self, key: tuple[str, str]) -> str:
        """Why an effect (name, place) was accepted and removed again; "" for all other effects."""
        return next((one.reason for one in self.set_aside if one.candidate.key == key), "")

    @property
    def unlikely(self) -> bool:
        """Whether the verdict is undecided only because no effect is probable enough."""
        trees, repeats = self.learnable, self.repeats
        of_rungs = verdict(self.rungs, self.floor, self.moment, trees=trees, repeats=repeats)
        return self.verdict == "undecided" and of_rungs == "effects_missing"

    @property
    def groups(self) -> tuple[tuple[Candidate, ...], ...]:
        """Groups of effects that explain the records equally well, the accepted one first."""
        return tuple(
            (r.added, *r.alternatives) for r in self.rungs if r.added is not None and r.alternatives
        )

    @property
    def look_alikes(self) -> tuple[tuple[Candidate, Candidate], ...]:
        """Accepted effects, each with one that gives nearly the same force over this travel.

        They are named nonetheless, because one of the two is the commoner by its file
        (`Effect.commoner`).
        """
        if self.prepared.is_of_an_arm:  # the links of an arm include gravity
            return ()
        doubted = dict.fromkeys(one.candidate for one in self.undetermined)
        return tuple((one, other) for one in doubted for other in list_look_alikes(one, self.model))

    @property
    def more_is_missing(self) -> bool:
        """Whether the final model leaves more than noise."""
        return not is_adequate(self.after, self.floor) and self.moment is None

    @property
    def may_be_noise(self) -> bool:
        """Whether the whole residual may be noise: sensors alone leave as much of the final model.

        The noise floor in use was limited below that value, so that no effect hides in it.
        """
        drawn = replace(self.floor, value=self.floor.drawn)
        return self.more_is_missing and self.floor.held and is_adequate(self.after, drawn)

    @property
    def floor_of_belief(self) -> NoiseFloor:
        """The noise floor that the probabilities of effects are computed with."""
        return self.floor if self.sensor_floor is None else self.sensor_floor

    @property
    def left(self) -> float:
        """Final error over the noise floor: of the force or at the command, the larger ratio."""
        return floors_left(self.after, self.floor)

    def plot(self) -> Figure:
        """Figure of forces, of the residual over time, velocity and position, and of the ladder."""
        return figure_of(self)

    def _repr_html_(self) -> str:
        return ladder_html(self.rungs, floor=self.floor.value, note=sentence(self))

    def __repr__(self) -> str:
        return ladder_text(self)

"""What a diagnosis states: rows of its ladder, candidates, open questions, what was set aside.

They are parts of an answer; `stored` annotations say where each stands in it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from ..base.codec import INLINE, OMIT, At, Error, Size
from ..base.errors import ExperimentError
from ..base.frozen import ByValue
from ..model import Model
from .candidates import Candidate
from .ranking import named_instead

#: how a diagnosis ends
VerdictName = Literal["effects_missing", "model_adequate", "undecided"]
#: why a candidate that leaves less does not count
Why = Literal["refused", "not determined"]
#: what the error of an older answer lacks
ANEW = "the answer of an earlier version, from which a diagnosis cannot be taken up again"


@dataclass(frozen=True, eq=False)
class EstimatedValue(ByValue):
    """A parameter's value with its standard error, in SI; NaN: not a number, or not determined."""

    value: float
    stderr: Error
    unit: str


@dataclass(frozen=True, eq=False)
class Alternative(ByValue):
    """An effect that explains the records as well as the one that was accepted at the same step.

    apart: standard deviations of chance between the two;  NaN: not known, as in an older answer
    likeness: correlation of the changes that the two make to the residual of the check records
    """

    candidate: Annotated[Candidate, INLINE]
    check_error: Error = math.nan
    apart: float = math.nan
    likeness: float = math.nan


@dataclass(frozen=True)
class JointErrors:
    """Relative force errors of one joint of an arm; NaN: no such record."""

    fit_error: Error
    check_error: Error


@dataclass(frozen=True, eq=False)
class LadderRow(ByValue):
    """One step of the ladder: the added effect and the errors of the model that has it.

    added: None: the user's model, re-estimated
    fit_error, check_error: relative force errors; NaN where there is no such record
    fitted: the model; None: an older answer holds that of the last row only
    instead_of: name of the effect of the user's model, at the same place, that the added replaced
    check_error_at_command: the check error as one of the recorded command; NaN: all is blind
    blind: share of the sliding samples in which the command has no influence
    could_be: other candidates that explain a good part of the same gain; stated where the model
        before left only noise, or the effect is not named
    alternatives: candidates that explain the records as well as the added one
    named: whether the effect is probable enough to be called missing
    follows: the joint whose motion the added effect depends on
    joints: joint of an arm -> its errors; the row's are then the root mean square over joints
    """

    added: Candidate | None
    fit_error: Error
    check_error: Error
    fitted: Annotated[Model | None, At("model")]
    instead_of: str | None = None
    check_error_at_command: Error = math.nan
    blind: Error = 0.0
    could_be: tuple[Candidate, ...] | None = None
    alternatives: tuple[Alternative, ...] = ()
    named: bool = False
    follows: Annotated[str | None, OMIT] = None
    joints: Annotated[Mapping[str, JointErrors], OMIT] = field(default_factory=dict)

    @property
    def model(self) -> Model:
        """The model, its parameters re-estimated; raises ExperimentError: an older answer."""
        if self.fitted is None:
            raise ExperimentError(f'no key "models": {ANEW}; diagnose anew, or leave --answer out')
        return self.fitted

    @property
    def title(self) -> str:
        """The added effect in words, with the effect that it replaced."""
        if self.added is None:
            return ""
        words = named_instead(self.added, self.instead_of)
        return words if self.follows is None else f"{words} by the motion of {self.follows}"

    def __repr__(self) -> str:
        errors = f"fit error {100 * self.fit_error:.2f} %, check error {100 * self.check_error:.2f}"
        return f"{self.title or 'the model'}: {errors} %"


@dataclass(frozen=True, eq=False)
class StepResult(ByValue):
    """Result of a candidate on one step: added to the model of one row of the ladder.

    score: how surely it lowers the error on the check records (standard deviations)
    outcome: what came of it in one or two words, such as "added", or ""
    determined: whether the records determine its parameters
    """

    check_error: Error
    score: float
    outcome: str
    determined: bool = True


@dataclass(frozen=True, eq=False)
class CandidateResult(ByValue):
    """A candidate with its fit at the step that accepted it, or where it was most probable.

    refused: the rule that excludes it whatever it explains; None: none does
    rho, lambda_, free_function: of an accepted effect: `free_functions.Belief`
    parameters: name in the effect -> estimate
    steps: its result for each row of the ladder, None where it was not fitted; (): not known
    """

    candidate: Annotated[Candidate, INLINE]
    probability: Size
    check_error: Error
    parameters: Mapping[str, EstimatedValue]
    check_error_at_command: Error = math.nan
    blind: Error = 0.0
    refused: str | None = None
    rho: Annotated[float | None, OMIT] = None
    lambda_: Annotated[float | None, OMIT, At("lambda")] = None
    free_function: Annotated[str, OMIT] = ""
    steps: tuple[StepResult | None, ...] = ()


@dataclass(frozen=True, eq=False)
class StepEvidence(ByValue):
    """The basis of the probability of a candidate at one step; see `probability`."""

    candidate: Annotated[Candidate, INLINE]
    accepted: bool
    as_good: bool
    score: float
    share: float
    explained: float


@dataclass(frozen=True, eq=False)
class OpenRival(ByValue):
    """A candidate that could replace an accepted effect, with the model it was compared by."""

    candidate: Annotated[Candidate, INLINE]
    model: Model
    check_error: Error = math.nan


@dataclass(frozen=True, eq=False)
class OpenQuestion(ByValue):
    """An accepted effect and its rivals that the records cannot exclude.

    added: the accepted effect; None: none was accepted
    """

    added: Candidate | None
    others: tuple[OpenRival, ...]


@dataclass(frozen=True)
class Undetermined:
    """A sentence on parameters of an accepted effect that the records do not determine."""

    candidate: Annotated[Candidate, INLINE]
    sentence: str

    def __str__(self) -> str:
        return f"{self.candidate}: {self.sentence}"


@dataclass(frozen=True, eq=False)
class SetAside(ByValue):
    """An effect that lowered the error and was removed again, with its error and the reason.

    of_readings: whether the effect only weakens errors of the readings: its own error then does not
        limit the noise floor of the model without it
    """

    candidate: Annotated[Candidate, INLINE]
    check_error: Error
    reason: str
    of_readings: Annotated[bool, OMIT] = False

    def __str__(self) -> str:
        return f"{self.candidate} ({100 * self.check_error:.2f} %): {self.reason}"


@dataclass(frozen=True, eq=False)
class NotAccepted(ByValue):
    """A candidate that would leave clearly less than the final model, and why it does not count.

    why: "refused" by a rule, with the reason, or "not determined" by the records
    """

    why: Why
    candidate: Annotated[Candidate, INLINE]
    check_error: Error
    check_error_at_command: Error
    reason: str


@dataclass(frozen=True, eq=False)
class Nearest(ByValue):
    """The candidate that comes nearest where none is supported; reason: why it was set aside."""

    candidate: Annotated[Candidate, INLINE]
    check_error: Error
    reason: str = ""


def estimate_of(model: Model, name: str) -> EstimatedValue:
    """The parameter of a model with this full name."""
    value = model.parameters[name]
    return EstimatedValue(finite(value.value), finite(value.stderr), model.unit(name))


def finite(number: float) -> float:
    """The number; NaN where it is not finite, as an answer file says it."""
    return float(number) if math.isfinite(number) else math.nan

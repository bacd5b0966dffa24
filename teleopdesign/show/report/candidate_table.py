"""The rows of the ladder, and every candidate with its result on each of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from ...base.sentences import percent_on_page as percent
from ...diagnose.diagnosis import Diagnosis
from ...diagnose.ranking import REFUSALS
from ...diagnose.statements import CandidateResult, LadderRow, StepResult
from ...measurement.experiment import Experiment
from ..diagnose.text import command_error_text, sentence


def sentence_of(entry: object | None) -> str:
    """The text of an entry of a diagnosis as a sentence; "" without an entry."""
    text = "" if entry is None else str(entry)
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def step_name(rung: LadderRow) -> str:
    """The effect that a row adds, with equally good ones: "stribeck at device"."""
    if rung.added is None:
        return "your model, re-estimated"
    return " or ".join((rung.title, *(str(one.candidate) for one in rung.alternatives)))


def describe_judgement(experiment: Experiment) -> str:
    """The records on which the errors are reported."""
    if experiment.check_records:
        return "records that were not fitted"
    return "blocks of the records that were held out of the fit"


#: beginning of a verdict -> the same on a page
HEADS = {"effects_missing: ": "Your model lacks ", "model_adequate": "Your model is adequate"}


def verdict(diagnosis: Diagnosis) -> str:
    """The verdict, and what becomes of the force error."""
    text = sentence(diagnosis).removeprefix("verdict: ")
    for head, words in HEADS.items():
        text = text.replace(head, words, 1) if text.startswith(head) else text
    before, after = percent(diagnosis.before.check_error), percent(diagnosis.after.check_error)
    change = f"falls from {before} to {after}" if len(diagnosis.rungs) > 1 else f"is {after}"
    return (
        f"{text[:1].upper()}{text[1:]} The force error on "
        f"{describe_judgement(diagnosis.experiment)} {change}; sensor noise alone would leave "
        f"{percent(diagnosis.floor.value)}."
    )


@dataclass(frozen=True)
class LadderLine:
    """One row of the ladder; errors are relative to the measured force, floors are noise floors.

    alike: effects that explain the records equally well
    at_command: error at the command and blind share in words, if they add information
    """

    name: str
    brief: str
    fit_error: float
    check_error: float
    floors: float
    alike: tuple[str, ...] = ()
    at_command: str | None = None


@dataclass(frozen=True)
class CandidateStep:
    """A column of the table of candidates: its heading, and the check error without a candidate."""

    heading: str
    check_error: float


@dataclass(frozen=True)
class NumberColumn:
    """A column with one number a candidate;  least: what is smaller is shown as less than this."""

    heading: str
    value: Callable[[CandidateResult], float | None]
    least: float = 0.0


#: columns between the effect and the steps: a column is a line here
COLUMNS = (NumberColumn("probability", lambda one: one.probability, least=0.005),)


@dataclass(frozen=True)
class CandidateRow:
    """A candidate, its number in each of `COLUMNS`, and its result on each step (None: none)."""

    effect: str
    at: str
    probability: float
    numbers: tuple[float | None, ...]
    steps: tuple[StepResult | None, ...]


def ladder_lines(diagnosis: Diagnosis) -> tuple[LadderLine, ...]:
    """Every row of the ladder, the user's model first."""
    floor = diagnosis.floor.value
    return tuple(
        LadderLine(
            name=step_name(r),
            brief="your model" if r.added is None else r.added.effect.name,
            fit_error=r.fit_error,
            check_error=r.check_error,
            floors=r.check_error / floor if floor else float("inf"),
            alike=tuple(str(one.candidate) for one in r.alternatives),
            at_command=None if diagnosis.joints else command_error_text(r),
        )
        for r in diagnosis.rungs
    )


def candidate_steps(diagnosis: Diagnosis) -> tuple[CandidateStep, ...]:
    """The steps on which candidates were fitted; only the best one where no others are known."""
    ladder = ladder_lines(diagnosis)
    if not any(c.steps for c in diagnosis.candidates):
        return (CandidateStep("at its best step", ladder[0].check_error),)
    return tuple(
        CandidateStep(f"with {line.brief}" if i else "on your model", line.check_error)
        for i, line in enumerate(ladder)
    )


def candidate_rows(diagnosis: Diagnosis) -> tuple[CandidateRow, ...]:
    """Every candidate with its check error on each step: added ones first, then by probability."""
    accepted = [r.added.key for r in diagnosis.rungs if r.added is not None]
    count = len(candidate_steps(diagnosis))
    rows = [
        CandidateRow(
            c.candidate.effect.name,
            c.candidate.at,
            c.probability,
            tuple(column.value(c) for column in COLUMNS),
            c.steps[:count] if c.steps else (_best_step(diagnosis, c),),
        )
        for c in diagnosis.candidates
    ]

    def place(row: CandidateRow) -> tuple[int, float, float]:
        key = (row.effect, row.at)
        order = accepted.index(key) if key in accepted else len(accepted)
        errors = (step.check_error for step in row.steps if step is not None)
        best = min((e for e in errors if math.isfinite(e)), default=math.inf)
        return order, -round(row.probability, 2), best

    return tuple(sorted(rows, key=place))


def _best_step(diagnosis: Diagnosis, one: CandidateResult) -> StepResult:
    """A candidate of an older answer: at the step that accepted it, or at its best step."""
    if one.candidate in {r.added for r in diagnosis.rungs}:
        outcome = "added"
    elif one.candidate in {c for group in diagnosis.groups for c in group}:
        outcome = "as good"
    else:
        refused = one.refused or ""
        outcome = refused if refused in ("", *REFUSALS) else "implausible"
    return StepResult(one.check_error, math.nan, outcome)

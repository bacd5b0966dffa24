"""The rows of the ladder, and every candidate with its result on each of them.

A row is a mapping, as the template and the data of the page take it. Errors are relative to the
measured force.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from ...base.sentences import percent_on_page as percent
from ...diagnose import Diagnosis
from ...diagnose.ranking import REFUSALS
from ...diagnose.statements import CandidateResult, LadderRow, StepResult
from ...measurement.experiment import Experiment
from ..diagnose.text import command_error_text
from ..diagnose.verdict import sentence

#: a row of a table of the page: name of a cell -> its content
PageRow = Mapping[str, Any]


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


def ladder_lines(diagnosis: Diagnosis) -> tuple[PageRow, ...]:
    """Every row of the ladder, the user's model first.

    Errors are relative to the measured force, floors are noise floors
    alike: effects that explain the records equally well
    at_command: error at the command and blind share in words, if they add information, else None
    """
    floor = diagnosis.floor.value
    return tuple(
        {
            "name": step_name(r),
            "brief": "your model" if r.added is None else r.added.effect.name,
            "fit_error": r.fit_error,
            "check_error": r.check_error,
            "floors": r.check_error / floor if floor else float("inf"),
            "alike": tuple(str(one.candidate) for one in r.alternatives),
            "at_command": None if diagnosis.joints else command_error_text(r),
        }
        for r in diagnosis.rungs
    )


def candidate_steps(diagnosis: Diagnosis) -> tuple[PageRow, ...]:
    """The steps on which candidates were fitted: heading, and the check error without a candidate.

    Only the best step where no others are known.
    """
    ladder = ladder_lines(diagnosis)
    if not any(c.steps for c in diagnosis.candidates):
        return ({"heading": "at its best step", "check_error": ladder[0]["check_error"]},)
    headings = ["on your model", *(f"with {line['brief']}" for line in ladder[1:])]
    return tuple(
        {"heading": heading, "check_error": line["check_error"]}
        for heading, line in zip(headings, ladder, strict=True)
    )


#: columns between the effect and the steps: a column is a line here. Heading -> the number of a
#: candidate, and the least one: what is smaller is shown as less than this
COLUMNS: Mapping[str, tuple[Callable[[CandidateResult], float | None], float]] = {
    "probability": (lambda one: one.probability, 0.005),
}


def candidate_rows(diagnosis: Diagnosis) -> tuple[PageRow, ...]:
    """Every candidate, its number in each of `COLUMNS`, and its result on each step (None: none).

    Added ones come first, then the more probable ones.
    """
    accepted = [r.added.key for r in diagnosis.rungs if r.added is not None]
    count = len(candidate_steps(diagnosis))
    rows = [
        {
            "effect": c.candidate.effect.name,
            "at": c.candidate.at,
            "probability": c.probability,
            "numbers": tuple(number(c) for number, _ in COLUMNS.values()),
            "steps": c.steps[:count] if c.steps else (_best_step(diagnosis, c),),
        }
        for c in diagnosis.candidates
    ]

    def place(row: PageRow) -> tuple[int, float, float]:
        key = (row["effect"], row["at"])
        order = accepted.index(key) if key in accepted else len(accepted)
        errors = (step.check_error for step in row["steps"] if step is not None)
        best = min((e for e in errors if math.isfinite(e)), default=math.inf)
        return order, -round(row["probability"], 2), best

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

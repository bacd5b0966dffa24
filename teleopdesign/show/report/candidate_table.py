"""The rungs of the ladder, and every candidate with its result on each of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ...diagnose import Diagnosis
from ...diagnose.answer import answer
from ...diagnose.ladder_text import command_error_text
from ...diagnose.ranking import REFUSALS, Ranked, Ranking
from ...diagnose.rung import Rung
from .words import step_name


@dataclass(frozen=True)
class LadderRow:
    """One rung; errors are relative to the measured force, floors are noise floors.

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
class CandidateScore:
    """Result of a candidate on one step; outcome: a word of `_outcome`, or ""."""

    check_error: float
    score: float
    outcome: str


@dataclass(frozen=True)
class CandidateStep:
    """A column of the table of candidates: its heading, and the check error without a candidate."""

    heading: str
    check_error: float


@dataclass(frozen=True)
class CandidateRow:
    """A candidate with its probability, and its result on each step (None: not fitted there)."""

    effect: str
    at: str
    probability: float
    steps: tuple[CandidateScore | None, ...]


def ladder_rows(diagnosis: Diagnosis) -> tuple[LadderRow, ...]:
    """Every rung of the ladder, the user's model first."""
    floor = diagnosis.floor.value
    return tuple(
        LadderRow(
            name=step_name(r),
            brief="your model" if r.added is None else r.added.effect.name,
            fit_error=r.fit.fit_error,
            check_error=r.fit.check_error,
            floors=r.fit.check_error / floor if floor else float("inf"),
            alike=tuple(map(str, r.alternatives)),
            at_command=command_error_text(r.fit),
        )
        for r in diagnosis.rungs
    )


def candidate_steps(diagnosis: Diagnosis) -> tuple[CandidateStep, ...]:
    """The steps on which candidates were fitted; for an answer from a file, only the best step."""
    ladder = ladder_rows(diagnosis)
    if diagnosis.recorded is not None:
        return (CandidateStep("at its best step", ladder[0].check_error),)
    return tuple(
        CandidateStep(f"with {row.brief}" if i else "on your model", row.check_error)
        for i, row in enumerate(ladder)
    )


def candidate_rows(diagnosis: Diagnosis) -> tuple[CandidateRow, ...]:
    """Every candidate with its check error on each step: added ones first, then by probability."""
    if diagnosis.recorded is not None:
        return tuple(_recorded_row(diagnosis, row) for row in diagnosis.recorded["candidates"])
    steps = [(r, r.ranking) for r in diagnosis.rungs if r.ranking is not None]
    rankings = [*((r, k) for r, k in steps), (None, diagnosis.last)]
    done: dict[tuple[str, str], list[CandidateScore | None]] = {}
    for i, (rung, ranking) in enumerate(rankings):
        for ranked in ranking.ranked:
            outcome = _outcome(rung, ranking, ranked)
            # what was added may have been fitted again since: one error for one model
            fit = rung.fit if rung is not None and outcome == "added" else ranked.fit
            result = CandidateScore(fit.check_error, ranked.score, outcome)
            done.setdefault(ranked.candidate.key, [None] * len(rankings))[i] = result
    accepted = [r.added.key for r, _ in steps if r.added is not None]
    rows = [
        CandidateRow(c["effect"], c["at"], c["probability"], tuple(done[(c["effect"], c["at"])]))
        for c in answer(diagnosis)["candidates"]
    ]

    def place(row: CandidateRow) -> tuple[int, float, float]:
        key = (row.effect, row.at)
        order = accepted.index(key) if key in accepted else len(accepted)
        best = min(t.check_error for t in row.steps if t is not None)
        return order, -round(row.probability, 2), best

    return tuple(sorted(rows, key=place))


def _recorded_row(diagnosis: Diagnosis, row: Mapping[str, Any]) -> CandidateRow:
    """A candidate as an answer describes it: at the step that accepted it, or at its best step."""
    key = (row["effect"], row["at"])
    if key in {r.added.key for r in diagnosis.rungs if r.added is not None}:
        outcome = "added"
    elif key in {c.key for group in diagnosis.groups for c in group}:
        outcome = "as good"
    else:
        refused = row.get("refused") or ""
        outcome = refused if refused in ("", *REFUSALS) else "implausible"
    error = row["check_error"]
    score = CandidateScore(math.nan if error is None else float(error), math.nan, outcome)
    return CandidateRow(*key, float(row["probability"]), (score,))


def _outcome(rung: Rung | None, ranking: Ranking, ranked: Ranked) -> str:
    """Outcome of a candidate at a step, if the error alone does not show it; else ""."""
    key = ranked.candidate.key
    if rung is not None and rung.added is not None and rung.added.key == key:
        return "added"
    if rung is not None and key in {c.key for c in rung.alternatives}:
        return "as good"
    if key in ranked.fit.model.absent:
        return "no gain"
    if ranked.refused:
        return ranked.refused
    if ranked.implausible:
        return "implausible"
    if not ranked.is_identifiable:
        return "open"
    return "displaces" if set(ranked.fit.at_bound) - set(ranking.base.at_bound) else ""

"""Open questions of a diagnosis: accepted effects that other effects could replace."""

from __future__ import annotations

from .criteria import CRITERIA
from .decision import is_supported
from .diagnosis import Diagnosis, OpenQuestion
from .left_out import possible_next
from .ranking import Ranked
from .rung import Rung
from .search_plan import PLAN


def open_questions(diagnosis: Diagnosis) -> tuple[OpenQuestion, ...]:
    """Open questions for the next experiment, from the fits of the diagnosis alone.

    There is one question per accepted effect that others could replace. There is one more, on the
    effect that would be added next, where the verdict is undecided or more than noise is left.
    """
    if diagnosis.open is not None:
        return diagnosis.open
    questions = [
        _question_of_rung(diagnosis, rung) for rung in diagnosis.rungs if rung.added is not None
    ]
    if diagnosis.verdict == "undecided" or _is_short(diagnosis):
        possible = possible_next(diagnosis)
        others = tuple((r.candidate, r.fit) for r in possible[: PLAN.rivals - 1])
        questions.append(OpenQuestion(None, others))
    return tuple(q for q in questions if q.others)


def _is_short(diagnosis: Diagnosis) -> bool:
    """Whether more than noise is surely left."""
    return diagnosis.more_is_missing and not diagnosis.may_be_noise


def _question_of_rung(diagnosis: Diagnosis, rung: Rung) -> OpenQuestion:
    """The accepted effect of a rung, and the candidates that could replace it."""
    assert rung.added is not None and rung.ranking is not None
    alternatives = {c.key for c in rung.alternatives}
    ranked = [r for r in rung.ranking.ranked if r.candidate.key != rung.added.key]
    close = sorted(
        (r for r in ranked if r.candidate.key in alternatives or _is_open(r, rung, diagnosis)),
        key=lambda r: (r.candidate.key not in alternatives, r.fit.check_error),
    )
    return OpenQuestion(rung.added, tuple((r.candidate, r.fit) for r in close[: PLAN.rivals - 1]))


def _is_open(ranked: Ranked, rung: Rung, diagnosis: Diagnosis) -> bool:
    """Whether a candidate could have been accepted too, and the check errors do not exclude it."""
    assert rung.ranking is not None and rung.added is not None
    added = next(r for r in rung.ranking.ranked if r.candidate.key == rung.added.key)
    more = ranked.fit.check_error**2 - added.fit.check_error**2
    near = more < (CRITERIA.open * diagnosis.floor.value) ** 2
    return near and is_supported(rung.ranking.base, ranked, diagnosis.floor)

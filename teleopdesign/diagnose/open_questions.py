"""Open questions of a diagnosis: accepted effects that other effects could replace."""

from __future__ import annotations

from .criteria import CRITERIA
from .decision import is_supported
from .ladder_end import LadderEnd
from .left_out import possible_next
from .ranking import Ranked
from .rung import Rung
from .search_plan import PLAN
from .statements import OpenQuestion, OpenRival, finite


def open_questions(end: LadderEnd) -> tuple[OpenQuestion, ...]:
    """Open questions for the next experiment, from the fits of the search alone.

    There is one question per accepted effect that others could replace. There is one more, on the
    effect that would be added next, where the verdict is undecided or more than noise is left.
    """
    questions = [_question_of_rung(end, rung) for rung in end.rungs if rung.added is not None]
    if end.verdict == "undecided" or _is_short(end):
        questions.append(OpenQuestion(None, _rivals(possible_next(end))))
    return tuple(q for q in questions if q.others)


def _rivals(ranked: list[Ranked]) -> tuple[OpenRival, ...]:
    """The first few of these candidates, each with its model."""
    return tuple(
        OpenRival(r.candidate, r.fit.model, finite(r.fit.check_error))
        for r in ranked[: PLAN.rivals - 1]
    )


def _is_short(end: LadderEnd) -> bool:
    """Whether more than noise is surely left."""
    return end.more_is_missing and not end.may_be_noise


def _question_of_rung(end: LadderEnd, rung: Rung) -> OpenQuestion:
    """The accepted effect of a rung, and the candidates that could replace it."""
    assert rung.added is not None and rung.ranking is not None
    alternatives = {c.key for c in rung.alternatives}
    ranked = [r for r in rung.ranking.ranked if r.candidate.key != rung.added.key]
    close = sorted(
        (r for r in ranked if r.candidate.key in alternatives or _is_open(r, rung, end)),
        key=lambda r: (r.candidate.key not in alternatives, r.fit.check_error),
    )
    return OpenQuestion(rung.added, _rivals(close))


def _is_open(ranked: Ranked, rung: Rung, end: LadderEnd) -> bool:
    """Whether a candidate could have been accepted too, and the check errors do not exclude it."""
    assert rung.ranking is not None and rung.added is not None
    added = next(r for r in rung.ranking.ranked if r.candidate.key == rung.added.key)
    more = ranked.fit.check_error**2 - added.fit.check_error**2
    near = more < (CRITERIA.open * end.floor.value) ** 2
    return near and is_supported(rung.ranking.base, ranked, end.floor)

"""What a ladder leaves open: accepted effects that others could replace, and what did not count."""

from __future__ import annotations

from collections.abc import Iterator

from .criteria import CRITERIA
from .decision import helps_but_is_barred, is_supported, lowers_check_squares, objection
from .ladder_state import LadderEnd
from .ranking import Ranked
from .rung import Rung
from .search_plan import PLAN
from .statements import Nearest, NotAccepted, OpenQuestion, OpenRival, VerdictName, Why, finite


def open_questions(end: LadderEnd, verdict: VerdictName) -> tuple[OpenQuestion, ...]:
    """Open questions for the next experiment, from the fits of the search alone.

    There is one question per accepted effect that others could replace. There is one more, on the
    effect that would be added next, where the verdict is undecided or more than noise is left.
    """
    questions = [_question_of_rung(end, rung) for rung in end.rungs if rung.added is not None]
    if verdict == "undecided" or end.more_is_missing:
        questions.append(OpenQuestion(None, _rivals(possible_next(end))))
    return tuple(q for q in questions if q.others)


def _rivals(ranked: list[Ranked]) -> tuple[OpenRival, ...]:
    """The first few of these candidates, each with its model."""
    return tuple(
        OpenRival(r.candidate, r.fit.model, finite(r.fit.check_error))
        for r in ranked[: PLAN.rivals - 1]
    )


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
    near = more < end.floor.value**2
    return near and is_supported(rung.ranking.base, ranked, end.floor)


def possible_next(end: LadderEnd) -> list[Ranked]:
    """The candidates that could be added next, best first: no rule excludes them."""
    last = end.last
    helpful = [r for r in last.ranked if r.counts and r.score > 0.0]
    return [r for r in helpful if not objection(last.base, r, end.floor)]


def _clearly_less(end: LadderEnd) -> float:
    """The squared check error below which a candidate leaves less than the final model."""
    return (1.0 - CRITERIA.relative_improvement) * end.after.check_error**2


def nearest(end: LadderEnd) -> Nearest | None:
    """The candidate with the least error where none is supported; None: none helps.

    Candidates that are listed beside an accepted one are not named a second time.
    """
    listed = [c for r in end.rungs if r.alternatives for c in (r.added, *r.alternatives)]
    best = next((r for r in possible_next(end) if r.candidate not in listed), None)
    if best is None or not best.fit.check_error**2 < _clearly_less(end):
        return None
    return Nearest(
        best.candidate, finite(best.fit.check_error), end.reason_set_aside(best.candidate.key)
    )


def not_accepted(end: LadderEnd) -> tuple[NotAccepted, ...]:
    """The candidates that leave clearly less than the final model, each with the reason.

    All that a rule refuses; where more than noise is left also a candidate whose values the records
    do not determine, if none that may count leaves less
    """
    return (*_list_refused(end), *_list_with_open_values(end))


def _list_refused(end: LadderEnd) -> Iterator[NotAccepted]:
    for r in end.last.ranked:
        why = helps_but_is_barred(end.last.base, r, end.floor)
        if why and r.fit.check_error**2 < _clearly_less(end):
            yield _state(r, "refused", why)


def _list_with_open_values(end: LadderEnd) -> Iterator[NotAccepted]:
    ranked, base = end.last.ranked, end.last.base
    allowed = [r for r in ranked if not (r.refused or r.implausible)]
    least = min(allowed, key=lambda r: r.fit.check_error, default=None)
    if least is None or least.counts or not end.more_is_missing:
        return
    if lowers_check_squares(base, least.fit):
        yield _state(least, "not determined", "these records do not determine its values")


def _state(ranked: Ranked, why: Why, reason: str) -> NotAccepted:
    error, at_command = ranked.fit.check_error, ranked.fit.at_command.error
    return NotAccepted(why, ranked.candidate, finite(error), finite(at_command), reason)

"""Candidates that would leave less force than the final model, and why they do not count."""

from __future__ import annotations

from collections.abc import Iterator

from .criteria import CRITERIA
from .decision import helps_but_is_barred, lowers_check_squares, objection
from .ladder_end import LadderEnd
from .ranking import Ranked
from .statements import Nearest, NotAccepted, Why, finite

#: a candidate is reported if its error is lower by more than this part of the last model's error: a
#: difference that a reader can see
LESS = 0.02


def possible_next(end: LadderEnd) -> list[Ranked]:
    """The candidates that could be added next, best first: no rule excludes them."""
    last = end.last
    helpful = [r for r in last.ranked if r.counts and r.score > 0.0]
    return [r for r in helpful if not objection(last.base, r, end.floor)]


def nearest(end: LadderEnd) -> Nearest | None:
    """The candidate with the least error where none is supported; None: none helps.

    Candidates that are listed beside an accepted one are not named a second time.
    """
    listed = [c for r in end.rungs if r.alternatives for c in (r.added, *r.alternatives)]
    best = next((r for r in possible_next(end) if r.candidate not in listed), None)
    least = (1.0 - CRITERIA.relevant) * end.after.check_error**2
    if best is None or not best.fit.check_error**2 < least:
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
        if why and r.fit.check_error < (1.0 - LESS) * end.after.check_error:
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

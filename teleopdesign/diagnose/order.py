"""The order of candidates, and the choice among candidates that explain the records equally well.

Candidates that count come first, then those that leave fewer squares on the check records
(`rank_key`). Among those that the records do not tell from the best, the simplest is taken
(`select_simplest`).
"""

from __future__ import annotations

from collections.abc import Sequence

from .candidates import Candidate
from .criteria import CRITERIA, Criteria
from .decision import is_supported
from .evidence import check_squares, whole_score
from .fit import Fit
from .noise_floor import NoiseFloor
from .ranking import Ranked, Ranking


def rank_key(ranked: Ranked) -> tuple[bool, float]:
    """Sort key of a ranking: candidates that count first, then by squares on the check records.

    To six digits, which is what a search resolves: two that are the same force stay in the order of
    the catalogue, on any machine.
    """
    return not ranked.counts, float(f"{check_squares(ranked.fit):.6g}")


def select_equals(supported: Sequence[Ranked], *, criteria: Criteria = CRITERIA) -> list[Ranked]:
    """The supported candidates, in order, that explain the records as well as the best one."""
    best = supported[:1]
    return [r for r in supported if r is best[0] or _is_equal(r, best[0], criteria)]


def _is_equal(one: Ranked, best: Ranked, criteria: Criteria) -> bool:
    """Whether the records cannot distinguish a candidate from the best one."""
    near = abs(one.fit.check_error - best.fit.check_error) < criteria.near * best.fit.check_error
    return near and whole_score(one.fit, best.fit) < criteria.close


def select_simplest(supported: Sequence[Ranked], *, criteria: Criteria = CRITERIA) -> Ranked:
    """Of the supported candidates, in order, the simplest that explains as well as the best.

    What the user's model has is believed: an effect in the place of another only where it is
    better.
    """
    equal = select_equals(supported, criteria=criteria)
    return min(equal, key=lambda r: (r.instead_of is not None, *simplicity(r.candidate)))


def alternatives_of(
    best: Ranked,
    ranking: Ranking,
    base: Fit,
    floor: NoiseFloor,
    *,
    criteria: Criteria = CRITERIA,
) -> tuple[Candidate, ...]:
    """Candidates that the records cannot distinguish from this one.

    One that needs more parameters to do as well explains nothing that the simpler does not.
    """
    supported = [r for r in ranking.ranked if is_supported(base, r, floor, criteria=criteria)]
    return tuple(
        r.candidate
        for r in select_equals(supported, criteria=criteria)
        if r is not best and simplicity(r.candidate)[0] == simplicity(best.candidate)[0]
    )


def select_other_helpers(best: Ranked, ranking: Ranking) -> tuple[Candidate, ...]:
    """Other effects that remove at least half as much as the best, by chance or not.

    To be said where the model before left only noise: there a gain is small, and what brings it
    about may be something else.
    """
    whole = check_squares(ranking.base)
    least = 0.5 * (whole - check_squares(best.fit))
    others = (r for r in ranking.ranked if r.counts and r.candidate != best.candidate)
    return tuple(r.candidate for r in others if whole - check_squares(r.fit) >= least)


def is_simpler(
    ranked: Ranked, dropped: Candidate, present: Fit, *, criteria: Criteria = CRITERIA
) -> bool:
    """Whether a candidate of the same role is simpler than an effect and leaves no more.

    A transmission may leave no more than friction does for it passes on less of what sensors read.
    Of two that are hardly told apart the one that acts on most machines stays.

    present: the fit with the effect that it takes the place of
    """
    if ranked.candidate.effect.commoner == dropped.effect.name:
        return False
    no_more = ranked.fit.check_error < (1.0 + criteria.near) * present.check_error
    return (
        ranked.candidate.effect.role == dropped.effect.role
        and simplicity(ranked.candidate) < simplicity(dropped)
        and no_more
        and whole_score(ranked.fit, present) < criteria.close
    )


def simplicity(candidate: Candidate) -> tuple[int, int, int]:
    """Parameters that must be estimated, effects that must be there, and optional parameters.

    Fewer is simpler.
    """
    effect = candidate.effect
    optional = sum(p.optional for p in effect.parameters.values())
    return len(effect.parameters) - optional, len(effect.needs), optional

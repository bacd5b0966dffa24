"""The order of candidates, and the choice among candidates that explain the records equally well.

Candidates that count come first, then those that leave fewer squares on the check records
(`rank_key`). Among the candidates that the records cannot distinguish from the best, the simplest
is accepted (`select_simplest`).
"""

from __future__ import annotations

from collections.abc import Sequence

from .candidates import Candidate
from .criteria import CRITERIA
from .decision import is_supported
from .evidence import check_squares, whole_score
from .fit import Fit
from .noise_floor import NoiseFloor
from .ranking import Ranked, Ranking


def rank_key(ranked: Ranked) -> tuple[bool, float]:
    """Sort key of a ranking: candidates that count come first, then those with fewer check squares.

    The squares are rounded to six digits, which is the accuracy of a search. So candidates with the
    same force keep the order of the catalogue, on any machine.
    """
    return not ranked.counts, float(f"{check_squares(ranked.fit):.6g}")


def select_equals(supported: Sequence[Ranked]) -> list[Ranked]:
    """The supported candidates, in order, that explain the records as well as the best one."""
    best = supported[:1]
    return [r for r in supported if r is best[0] or _is_equal(r, best[0])]


def _is_equal(one: Ranked, best: Ranked) -> bool:
    """Whether the records cannot distinguish a candidate from the best one."""
    least = best.fit.check_error**2
    differ = abs(one.fit.check_error**2 - least) >= CRITERIA.relative_improvement * least
    return not differ and whole_score(one.fit, best.fit) < CRITERIA.indistinguishable


def select_simplest(supported: Sequence[Ranked]) -> Ranked:
    """The simplest supported candidate that explains the records as well as the best one.

    supported: in the order of the ranking
    A candidate that replaces an effect of the model is preferred only where it is better.
    """
    equal = select_equals(supported)
    return min(equal, key=lambda r: (r.instead_of is not None, *simplicity(r.candidate)))


def alternatives_of(
    best: Ranked, ranking: Ranking, base: Fit, floor: NoiseFloor
) -> tuple[Candidate, ...]:
    """Supported candidates that the records cannot distinguish from this one.

    Only candidates with as many necessary parameters count: one that needs more is no simpler
    explanation.
    """
    supported = [r for r in ranking.ranked if is_supported(base, r, floor)]
    return tuple(
        r.candidate
        for r in select_equals(supported)
        if r is not best and simplicity(r.candidate)[0] == simplicity(best.candidate)[0]
    )


def look_alikes_of(one: Ranked, ranking: Ranking) -> tuple[Candidate, ...]:
    """Candidates that explain as much as this one, whether or not it is the best, or supported."""
    parameters = simplicity(one.candidate)[0]
    return tuple(
        r.candidate
        for r in ranking.ranked
        if r is not one and r.counts and _is_equal(r, one)
        if simplicity(r.candidate)[0] == parameters
    )


def select_other_helpers(best: Ranked, ranking: Ranking) -> tuple[Candidate, ...]:
    """Other effects that remove at least half as many check squares as the best, by chance or not.

    They are named where the model before left only noise: there the gain is small, and another
    effect may cause it.
    """
    whole = check_squares(ranking.base)
    least = 0.5 * (whole - check_squares(best.fit))
    others = (r for r in ranking.ranked if r.counts and r.candidate != best.candidate)
    return tuple(r.candidate for r in others if whole - check_squares(r.fit) >= least)


def simplicity(candidate: Candidate) -> tuple[int, int, int]:
    """Numbers of necessary parameters, of effects that must be present, and of optional parameters.

    Fewer is simpler; compared in this order.
    """
    effect = candidate.effect
    optional = sum(p.optional for p in effect.parameters.values())
    return len(effect.parameters) - optional, len(effect.needs), optional

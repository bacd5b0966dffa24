"""Moves of a ladder by two effects at once, for effects that mask each other.

Of sixteen simulated devices that lack two effects, fifteen get the same answer without these moves.
One, a gain of the actuator beside damping that depends on the direction, would be undecided.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from .adequacy import is_adequate
from .candidates import Candidate
from .decision import is_better, is_supported
from .evidence import check_score, check_squares
from .fit import Fit, fit_squares
from .ladder_state import LadderSearch, LadderState
from .noise_floor import NoiseFloor
from .order import alternatives_of, look_alikes_of
from .outside_tone import best_tone
from .ranking import Ranking
from .rung import Rung, make_replaced
from .rungs import estimate_without, order_by_falling_error
from .verdict import explained_share


def add_pair(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Add two effects that the records support only together; only as the first move.

    Beside accepted effects, the search for a pair costs more time than it gains.
    """
    if state.step > 1:
        return None
    pair = _best_pair(search, state, state.ranking)
    return state.with_rungs((*state.rungs, *pair)) if pair is not None else None


def replace_by_pair(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Replace the rungs, once, by two effects that explain most of the remaining error.

    Where two effects are missing, a third may explain more than either alone, and is accepted
    first: Maxwell slip explains a part of a spring and a bristle. The second effect may explain
    nothing alone: with rigid friction, the Stribeck effect cannot be observed where bristles bend.
    Where only noise is left, a pair may replace an effect with many parameters, which may imitate
    two effects.
    """
    ranking = state.rungs[1].ranking if state.step > 1 else None
    if state.replaced or ranking is None:
        return None
    noise = is_adequate(state.fit, state.floor, criteria=search.criteria)
    if noise and not _has_many_parameters(search, state):
        return None
    alone = [r.candidate for r in ranking.ranked if r.counts]
    among = None if search.plan.partial_pairs else alone
    pair = _best_pair(search, state, ranking, among)
    if pair is None or not _explains_most(search, state, pair[-1].fit):
        return None
    if noise and not _is_better_and_no_larger(search, state, pair[-1].fit):
        return None
    return replace(state.with_rungs((state.rungs[0], *pair)), replaced=True)


def _has_many_parameters(search: LadderSearch, state: LadderState) -> bool:
    """Whether an added effect has so many parameters that it may imitate two effects."""
    added = (rung.added for rung in state.rungs if rung.added is not None)
    return any(len(one.effect.parameters) >= search.plan.many_parameters for one in added)


def _is_better_and_no_larger(search: LadderSearch, state: LadderState, both: Fit) -> bool:
    """Whether a fit leaves surely less than the last rung, with no more free parameters."""
    no_more = len(both.free) <= len(state.fit.free)
    return no_more and check_score(state.fit, both) > search.criteria.sure


def _explains_most(search: LadderSearch, state: LadderState, both: Fit) -> bool:
    """Whether a fit leaves only noise, or less than half of the last rung's squares above it."""
    criteria, floor = search.criteria, state.floor
    if is_adequate(both, floor, criteria=criteria):
        return True
    if not search.plan.partial_pairs:
        return False
    better = is_better(state.fit, both, floor, criteria=criteria)
    return better and explained_share(state.fit, both, floor) >= criteria.mostly


def _best_pair(
    search: LadderSearch,
    state: LadderState,
    ranking: Ranking,
    among: Collection[Candidate] | None = None,
) -> tuple[Rung, ...] | None:
    """The best pair of rungs added to the user's model; None where no pair is supported.

    Each of the best few candidates of the ranking is added, and all candidates at its body (or
    those in `among`) are ranked again on top of it. A pair counts where it explains most of the
    missing force and neither effect can be left out.
    """
    base, floor, criteria = state.rungs[0], state.floor, search.criteria
    here = base.fit
    if is_adequate(here, floor, criteria=criteria):
        return None
    pairs: list[tuple[Rung, ...]] = []
    gone = {one.candidate.key for one in state.set_aside}
    trials = [
        r
        for r in ranking.ranked
        if r.counts and r.candidate.key not in gone and fit_squares(r.fit) < fit_squares(here)
    ]
    for first in trials[: search.plan.trials]:
        # all effects were ranked beside this effect before
        if frozenset(first.fit.model.effects) in state.visited:
            continue
        # bodies do not act on each other along measured motions: effects of two never mask another
        body = here.model.holder(first.candidate.at)
        beside = search.rank(first.fit, step=state.step, among=among, body=body)
        supported = (
            r
            for r in beside.ranked
            if r.candidate.key not in gone and is_supported(first.fit, r, floor, criteria=criteria)
        )
        second = next((r for r in supported if r.instead_of != first.candidate), None)
        if second is None:
            continue
        alternatives = alternatives_of(second, beside, first.fit, floor, criteria=criteria)
        rungs = (
            Rung(
                first.candidate,
                first.fit,
                ranking,
                look_alikes_of(first, ranking, criteria=criteria),
                replaced=make_replaced(first, here.model),
            ),
            Rung(
                second.candidate,
                second.fit,
                beside,
                alternatives,
                replaced=make_replaced(second, first.fit.model),
            ),
        )
        if _needs_both(search, here, rungs, floor):
            order = order_by_falling_error((base, *rungs), search.prepared)
            pairs += [order[1:]] if order is not None else []
    return min(pairs, key=lambda rungs: check_squares(rungs[-1].fit), default=None)


def _needs_both(
    search: LadderSearch, base: Fit, rungs: tuple[Rung, ...], floor: NoiseFloor
) -> bool:
    """Whether two effects together explain most of the missing force and both are needed."""
    both, first, criteria = rungs[-1].fit, rungs[0], search.criteria
    if not is_better(base, both, floor, criteria=criteria):
        return False
    if explained_share(base, both, floor) < criteria.mostly:
        return False
    if not best_tone(base, search.prepared).is_beaten_by(both):
        return False
    without = estimate_without(both.model, first, search.prepared)
    # None: the second effect needs the first
    return without is None or is_better(without, both, floor, criteria=criteria)

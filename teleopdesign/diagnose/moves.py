"""Moves of a ladder by one effect: add an effect, or remove one that others made superfluous.

A move takes a search and a state and returns the next state, or None where no such move is
supported. Decisions use the noise floor of the state.
"""

from __future__ import annotations

from dataclasses import replace

from .adequacy import is_adequate, is_noise
from .decision import is_better
from .fit import Fit
from .ladder_state import LadderSearch, LadderState
from .noise_floor import noise_floor
from .order import alternatives_of, select_other_helpers, select_simplest
from .ranking import Ranked
from .rung import Rung, make_replaced
from .rungs import estimate_without, reorder_and_refit


def add(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with one more effect: the simplest that explains the records as well as the best.

    The effect may replace an effect of the user's model, or one that was added before.
    """
    criteria = search.criteria
    supported = [r for r in state.supported if not _takes_back(r, state)]
    while supported:
        best = select_simplest(supported, criteria=criteria)
        moved = _add_candidate(search, state, best)
        if moved is not None:
            return moved
        supported.remove(best)
    return None


def _takes_back(ranked: Ranked, state: LadderState) -> bool:
    """Whether a candidate would replace an effect of `LadderState.came_back`."""
    return ranked.instead_of is not None and ranked.instead_of.key in state.came_back


def _add_candidate(search: LadderSearch, state: LadderState, best: Ranked) -> LadderState | None:
    criteria, prepared = search.criteria, search.prepared
    alternatives = alternatives_of(best, state.ranking, state.fit, state.floor, criteria=criteria)
    noise = is_adequate(state.fit, state.floor, criteria=criteria)
    rung = Rung(
        best.candidate,
        best.fit,
        state.ranking,
        alternatives,
        replaced=make_replaced(best, state.fit.model),
        could_be=select_other_helpers(best, state.ranking) if noise else None,
    )
    for earlier in state.rungs[1:]:
        assert earlier.added is not None
        # both effects are in the model now: nothing is replaced
        if earlier.instead_of == best.candidate:
            rungs = [replace(r, replaced=None) if r is earlier else r for r in state.rungs]
            order = reorder_and_refit(rungs, best.fit, prepared)
            if order is None:
                return None
            back = state.came_back | {best.candidate.key}
            return replace(state.with_rungs(order), came_back=back)
        if best.instead_of == earlier.added:  # the earlier effect only imitated the new one
            kept = [r for r in state.rungs if r is not earlier]
            rung = replace(rung, replaced=earlier.replaced)
            order = reorder_and_refit([*kept, rung], best.fit, prepared)
            if order is None:
                return None
            return replace(state.with_rungs(order), came_back=state.came_back | {earlier.added.key})
    return state.with_rungs((*state.rungs, rung))


def remove(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Remove one effect that later effects made superfluous, and fit the others again."""
    last = state.fit
    for rung in state.rungs[1:-1]:
        without = estimate_without(last.model, rung, search.prepared)
        if without is None or not _is_enough(search, without, state):
            continue
        fewer = [r for r in state.rungs if r is not rung]
        order = reorder_and_refit(fewer, without, search.prepared)
        return state.with_rungs(order) if order is not None else None
    return None


def _is_enough(search: LadderSearch, without: Fit, state: LadderState) -> bool:
    """Whether a fit with one effect less is as good as the last, or leaves only sensor noise.

    A clock that jitters seems to demand a force that never acted. An effect that weakens this error
    is no physical effect if the model without it leaves no more than the jitter causes.
    """
    if not is_better(without, state.fit, state.floor, criteria=search.criteria):
        return True
    if not state.floor.jitters:
        return False
    floor = noise_floor(without.model, search.prepared, search.generator())
    return is_noise(without.check_error, floor, criteria=search.criteria)

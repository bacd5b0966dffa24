"""Moves of a ladder by one effect: add one, or remove one that others have made superfluous.

A move takes a search and a state and gives the state that it leads to, or None: no such move is
supported. It is judged by the noise floor that the state holds.
"""

from __future__ import annotations

from .decision import alternatives_of, is_better, preferred
from .ladder_state import LadderSearch, LadderState
from .rung import Rung
from .rungs import estimate_without, falling, refitted


def add(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Add the simplest effect that explains the records as well as the best supported one."""
    if not state.supported:
        return None
    criteria = search.criteria
    best = preferred(state.supported, criteria=criteria)
    alternatives = alternatives_of(best, state.ranking, state.fit, state.floor, criteria=criteria)
    return state.with_rungs(
        (*state.rungs, Rung(best.candidate, best.fit, state.ranking, alternatives))
    )


def remove(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Remove an effect that later effects made superfluous, and fit the others again."""
    last = state.fit
    for rung in state.rungs[1:-1]:
        assert rung.added is not None
        without = estimate_without(last.model, rung.added, search.prepared)
        if without is None or is_better(without, last, state.floor, criteria=search.criteria):
            continue
        fewer = [r for r in state.rungs if r is not rung]
        order = falling(refitted(fewer, without, search.prepared), search.prepared)
        return state.with_rungs(order) if order is not None else None
    return None

"""The move that puts two simpler effects in the place of one.

A spring and a constant force are one spring whose neutral place is not where the encoder reads
zero. Alone, each is worse than an effect with a place of its own: gravity, or stops that are hardly
apart.
"""

from __future__ import annotations

from .criteria import CRITERIA
from .decision import is_better, is_supported
from .evidence import whole_score
from .fit import Fit
from .ladder_state import LadderSearch, LadderState
from .moves import in_order, list_simpler_of_role
from .rung import Rung, estimate_without


def swap_for_two(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with two simpler effects in the place of the last one.

    They leave clearly less, or as much with fewer parameters.
    """
    rung = state.rungs[-1]
    simpler = list_simpler_of_role(rung, state) if rung.added is not None else ()
    if rung.replaced is not None or not simpler[1:]:
        return None
    without = estimate_without(state.fit.model, rung, search.prepared)
    if without is None:
        return None
    ranking = search.rank(without, step=state.step, among=simpler)
    for first in ranking.ranked:
        others = [c for c in simpler if c != first.candidate]
        beside = search.rank(first.fit, step=state.step, among=others)
        for second in beside.ranked:
            replaces = first.instead_of is not None or second.instead_of is not None
            if replaces or not is_supported(first.fit, second, state.floor):
                continue
            if not (
                _is_simpler(second.fit, state) or is_better(state.fit, second.fit, state.floor)
            ):
                continue
            pair = (
                Rung(first.candidate, first.fit, ranking),
                Rung(second.candidate, second.fit, beside),
            )
            moved = in_order(search, state, [*state.rungs[:-1], *pair], second.fit)
            if moved is None or moved.effects in state.visited:
                continue
            return moved
    return None


def _is_simpler(fit: Fit, state: LadderState) -> bool:
    """Whether a fit has fewer parameters than that of a state, which explains no more."""
    fewer = len(fit.model.parameters) < len(state.fit.model.parameters)
    return fewer and whole_score(fit, state.fit) < CRITERIA.indistinguishable

"""Exchange: an accepted effect is replaced by a better or simpler one.

A better effect explains the records better together with all other effects; a simpler one explains
them as well with fewer parameters.
Effects are added one at a time, so an early effect may only imitate effects that were added later.
If more than noise is left at the end, each effect that others followed is removed once, and the
rivals that it beat when it was added are ranked in its place. Effects that explained the records
equally well when one of them was added are compared again together with later effects.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

from .adequacy import is_adequate
from .candidates import Candidate
from .criteria import CRITERIA, Criteria
from .decision import is_better, is_supported
from .evidence import check_squares
from .fit import Fit
from .ladder_state import LadderSearch, LadderState
from .moves import remove
from .noise_floor import NoiseFloor
from .order import alternatives_of, is_simpler, select_equals
from .ranking import Ranked, Ranking
from .rung import Replaced, Rung
from .rungs import estimate_without, reorder_and_refit


@dataclass(frozen=True)
class Exchange:
    """The replacement of one effect by another.

    dropped: the effect that is replaced;  without: the fit without it, which both are compared with
    replacement: the new effect, with the model fitted with it
    ranking: all candidates for this place
    """

    dropped: Candidate
    without: Fit
    replacement: Ranked
    ranking: Ranking


def exchange(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder after the best exchange, without superfluous effects; None: no exchange."""
    criteria, prepared, floor = search.criteria, search.prepared, state.floor
    if state.exchanges >= search.plan.exchanges or is_adequate(state.fit, floor, criteria=criteria):
        return None
    there = [r.added for r in state.rungs if r.added is not None]
    there += [one.candidate for one in state.set_aside]
    rivals = {
        r.added: rivals_of(r.ranking, there, floor, criteria=criteria)
        for r in _list_followed(state)
        if r.added is not None and r.ranking is not None
    }
    replaced = {r.added: r.replaced for r in state.rungs if r.added is not None}
    best = best_exchange(search, state.fit, rivals, floor, step=state.step, replaced=replaced)
    if best is None:
        return None
    replacement, without = best.replacement, best.without
    alternatives = alternatives_of(replacement, best.ranking, without, floor, criteria=criteria)
    rung = Rung(replacement.candidate, replacement.fit, best.ranking, alternatives)
    kept = [r for r in state.rungs if r.added is not best.dropped]
    order = reorder_and_refit([*kept, rung], replacement.fit, prepared)
    if order is None:
        return None
    moved = replace(state.with_rungs(order), exchanges=state.exchanges + 1)
    return remove(search, moved) or moved


def compare_alternatives(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with fewer alternatives of a rung, as later effects may distinguish them.

    The best alternative becomes the effect of the rung, unless the accepted one is still as good.
    returns: None where no rung has fewer alternatives than before
    """
    for rung in _list_followed(state):
        if rung.added is None or not rung.alternatives or rung.replaced is not None:
            continue
        without = estimate_without(state.fit.model, rung, search.prepared)
        if without is None:
            continue
        among = (rung.added, *rung.alternatives)
        ranking = search.rank(without, step=state.step, among=among)
        supported = [
            r
            for r in ranking.ranked
            if r.instead_of is None
            and is_supported(without, r, state.floor, criteria=search.criteria)
        ]
        equal = select_equals(supported, criteria=search.criteria)
        if not 0 < len(equal) < len(among):
            continue
        kept = next((r for r in equal if r.candidate == rung.added), equal[0])
        others = tuple(r.candidate for r in equal if r is not kept)
        best = replace(rung, added=kept.candidate, fit=kept.fit, alternatives=others)
        rungs = [best if r is rung else r for r in state.rungs]
        order = reorder_and_refit(rungs, kept.fit, search.prepared)
        if order is not None:
            return state.with_rungs(order)
    return None


def _list_followed(state: LadderState) -> list[Rung]:
    """Rungs that were ranked without all of the other effects; these may change their place.

    The last rung is included only where an earlier rung changed after it was added.
    """
    added = list(state.rungs[1:])
    last = state.rungs[-1].ranking
    beside = last is None or last.base is state.rungs[-2].fit
    return added[:-1] if beside else added


def rivals_of(
    ranking: Ranking,
    there: Collection[Candidate],
    floor: NoiseFloor,
    *,
    criteria: Criteria = CRITERIA,
) -> list[Candidate]:
    """Supported candidates of a ranking that the final model lacks.

    there: effects that are no rivals: those of the final model, and those that were set aside
    """
    keys = {c.key for c in there}
    supported = [
        r.candidate
        for r in ranking.ranked
        if is_supported(ranking.base, r, floor, criteria=criteria)
    ]
    return [c for c in supported if c.key not in keys]


def best_exchange(
    search: LadderSearch,
    present: Fit,
    rivals: Mapping[Candidate, Collection[Candidate]],
    floor: NoiseFloor,
    *,
    step: int = 1,
    replaced: Mapping[Candidate, Replaced | None] | None = None,
) -> Exchange | None:
    """The exchange with the smallest check error.

    present: the fit with all accepted effects
    rivals: accepted effect -> candidates that may replace it
    step: number of the rung that is searched
    replaced: accepted effect -> effect that returns to the model when the accepted one is removed
    returns: None where no exchange clearly lowers the error, and none is simpler and as good
    """
    criteria, exchanges = search.criteria, []
    for dropped, among in rivals.items():
        if not among:
            continue
        rung = Rung(dropped, present, replaced=(replaced or {}).get(dropped))
        without = estimate_without(present.model, rung, search.prepared)
        if without is None:
            continue
        ranking = search.rank(without, step=step, among=among)
        better = [
            r
            for r in ranking.ranked
            if r.instead_of is None
            and is_supported(without, r, floor, criteria=criteria)
            and (
                is_better(present, r.fit, floor, criteria=criteria)
                or is_simpler(r, dropped, present, criteria=criteria)
            )
        ]
        if better:
            replacement = min(better, key=lambda r: check_squares(r.fit))
            exchanges.append(Exchange(dropped, without, replacement, ranking))
    return min(exchanges, key=lambda e: check_squares(e.replacement.fit), default=None)

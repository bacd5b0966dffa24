"""A move of a ladder: add a transmission with friction behind it, as most gears have.

This is a pair like others (`pairs`), but a search with one of the two effects does not lead to the
other: friction does not help a gap that was fitted without friction. So the search starts at
simulated motions of the tip (`tip_start`).

A soft transmission with friction behind it also imitates the friction of the actuator. So the pair
is added only beside that friction (`Effect.after`), whether the user stated it or it was accepted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from ..base.errors import ModelError
from .adequacy import is_adequate
from .candidates import Candidate, comes_too_early
from .cores import map_on_cores
from .criteria import CRITERIA
from .decision import is_better, is_supported, objection
from .evidence import check_squares
from .fit import Fit, estimate
from .ladder_state import LadderSearch, LadderState
from .outside_tone import best_tone
from .rank import make_ranked
from .ranking import Ranking
from .rung import Rung
from .rungs import estimate_without, order_by_falling_error, reorder_and_refit
from .search import base_of, estimate_best_start
from .tip_start import tip_starts
from .verdict import explained_share
from .width import OpenWidths


def add_transmission(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Add a transmission with friction behind it, or replace added effects by the two.

    The added effects are replaced where the two explain most of the squares that the rungs leave,
    except those that the two could imitate.
    returns: None where no such pair is supported
    """
    if is_adequate(state.fit, state.floor) or not search.plan.tip_starts:
        return None
    staying = _rungs_to_stay(search, state)
    for rungs in (staying, state.rungs) if len(staying) < state.step else (state.rungs,):
        ranking = state.ranking if rungs is state.rungs else None
        if len(rungs) == 1 and state.step > 1:
            ranking = state.rungs[1].ranking
        pair = _best_pair(search, state, rungs[-1].fit, ranking)
        order = pair and order_by_falling_error((*rungs, *pair), search.prepared)
        if not order or frozenset(order[-1].fit.model.effects) in state.visited:
            continue
        return state.with_rungs(order)
    return None


def _rungs_to_stay(search: LadderSearch, state: LadderState) -> tuple[Rung, ...]:
    """The user's model, and the added effects that friction behind a transmission could imitate.

    All rungs where these effects do not stand without the others.
    """
    known = state.fit.model.known.values()
    imitated = {name for e in known if e.role == "tip_level" for name in e.after}
    staying = [r for r in state.rungs if r.added is None or r.added.effect.name in imitated]
    if len(staying) == 1:
        return state.rungs[:1]
    model = state.fit.model
    try:
        for rung in reversed(state.rungs):
            if all(rung is not one for one in staying):
                model = rung.undo_addition(model)
    except ModelError:
        return state.rungs
    last = estimate(model, search.prepared)
    return reorder_and_refit(staying, last, search.prepared) or state.rungs


def _best_pair(
    search: LadderSearch, state: LadderState, base: Fit, ranking: Ranking | None
) -> tuple[Rung, ...] | None:
    """The best transmission with friction behind it, added to a base; None: none is supported.

    ranking: of the candidates added to the base; None: not known
    """
    alone = {r.candidate.key: r.fit for r in ranking.ranked} if ranking is not None else {}
    possible = list(_possible_pairs(base))

    def begun(i: int) -> None:
        transmission, friction = possible[i]
        search.progress(f"trying {transmission} with {friction.effect.name}")

    def fit(both: tuple[Candidate, Candidate]) -> tuple[Rung, Rung] | None:
        return _fit_pair(search, base, *both, alone.get(both[0].key))

    pairs = map_on_cores(fit, possible, begun=begun)
    supported = [
        pair for pair in pairs if pair is not None and _is_supported(search, state, base, pair)
    ]
    return min(supported, key=lambda pair: check_squares(pair[-1].fit), default=None)


def _possible_pairs(base: Fit) -> Iterator[tuple[Candidate, Candidate]]:
    """Each transmission that a body can take, with each friction that then can act at its tip.

    None where the body lacks the friction that the pair could imitate.
    """
    for place, body in base.model.bodies.items():
        if any(e.role == "structure" for e in body.effects):
            continue
        known = base.model.known.values()
        for transmission in (e for e in known if e.role == "structure" and e.led is not None):
            whole = base.model.with_effect(transmission, at=place).body(place)
            for friction in (e for e in known if e.role == "tip_level"):
                if comes_too_early(friction, place, base.model):
                    continue
                if not (whole.has(friction.name) or whole.lacks(friction)):
                    yield Candidate(transmission, place), Candidate(friction, place)


def _fit_pair(
    search: LadderSearch,
    base: Fit,
    transmission: Candidate,
    friction: Candidate,
    ranked_alone: Fit | None,
) -> tuple[Rung, Rung] | None:
    """Two rungs: the transmission alone, and both effects; None: no start, or not separable.

    ranked_alone: fit of the transmission as a single candidate. A fit that starts from the values
        of both effects may leave more than the base
    """
    prepared = search.prepared
    coarse = base_of(base, prepared).coarse
    starts = tip_starts(coarse, prepared.coarse, transmission, friction, plan=search.plan)
    if not starts:
        return None
    new = (transmission.key, friction.key)
    both = estimate_best_start([one.model for one in starts], new, prepared)
    alone = estimate_without(both.model, Rung(friction, both), prepared)
    if alone is None:
        return None
    if ranked_alone is not None:
        alone = min((alone, ranked_alone), key=check_squares)
    rank = partial(make_ranked, prepared=prepared, widths=OpenWidths(prepared))
    # alone, a transmission explains little and may have no gap: it is judged together with friction
    first = replace(rank(base, transmission, both), fit=alone)
    return (
        Rung(transmission, alone, Ranking(base, (first,))),
        Rung(friction, both, Ranking(alone, (rank(alone, friction, both),))),
    )


def _is_supported(
    search: LadderSearch, state: LadderState, base: Fit, pair: tuple[Rung, ...]
) -> bool:
    """Whether both effects are needed and plausible, and explain most of what the last rung leaves.

    Effects that were set aside are not supported again.
    """
    floor, both = state.floor, pair[-1].fit
    added = {rung.added.key for rung in pair if rung.added is not None}
    if added & {one.candidate.key for one in state.set_aside}:
        return False
    first, second = (rung.ranking.ranked[0] for rung in pair if rung.ranking is not None)
    return (
        not objection(base, replace(first, fit=both), floor)
        and first.is_identifiable
        and is_supported(pair[0].fit, second, floor)
        and is_better(base, both, floor)
        and is_better(state.fit, both, floor)
        and explained_share(state.fit, both, floor) >= CRITERIA.mostly
        and best_tone(base, search.prepared).is_beaten_by(both)
    )

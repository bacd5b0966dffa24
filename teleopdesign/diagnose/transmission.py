"""A move of a ladder: add a transmission with friction behind it, as most gears have.

This is a pair as in `moves.add_two`, but a search with one of the two effects does not lead to the
other: friction does not help a gap that was fitted without friction. So both are drawn together
(`draws`). Three simulated gears are named whole; without this move two are slipping springs, and
one a spring with 12 % left.

A soft transmission with friction behind it also imitates the friction of the actuator. So the pair
is added only beside that friction (`Effect.after`), whether the user stated it or it was accepted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

from .candidates import Candidate, comes_too_early
from .criteria import CRITERIA
from .decision import is_better, is_supported, objection
from .draws import best_draws
from .evidence import check_squares, explained_share, is_adequate
from .fit import Fit, estimate
from .ladder_state import LadderSearch, LadderState
from .outside_tone import best_tone
from .rank import make_ranked
from .ranking import Ranking
from .rung import Rung, estimate_without, order_by_falling_error, reorder_and_refit, undo
from .search import base_of, estimate_best_start


def add_transmission(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Add a transmission with friction behind it, or replace added effects by the two.

    The added effects are replaced where the two explain most of the squares that the rungs leave,
    except those that the two could imitate.
    returns: None where no such pair is supported
    """
    if is_adequate(state.fit, state.floor) or not search.draws_gaps:
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
    others = [r for r in reversed(state.rungs) if all(r is not one for one in staying)]
    if (model := undo(others, state.fit.model)) is None:
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
    pairs: list[tuple[Rung, ...]] = []
    for transmission, friction in _possible_pairs(base):
        search.progress(f"trying {transmission} with {friction.effect.name}")
        both = _fit_both(search, base, transmission, friction)
        pairs += _as_rungs(search, base, transmission, friction, both, alone)
    supported = [pair for pair in pairs if _is_supported(search, state, base, pair)]
    return min(supported, key=lambda pair: check_squares(pair[-1].fit), default=None)


def _possible_pairs(base: Fit) -> Iterator[tuple[Candidate, Candidate]]:
    """Each transmission that a body can take, with each friction that then can act at its tip.

    The one with the fewest parameters first. None where the body lacks the friction that the pair
    could imitate.
    """
    known = sorted(base.model.known.values(), key=lambda e: len(e.parameters))
    for place, body in base.model.bodies.items():
        if any(e.role == "structure" for e in body.effects):
            continue
        for transmission in (e for e in known if e.role == "structure" and e.led is not None):
            whole = base.model.with_effect(transmission, at=place).body(place)
            for friction in (e for e in known if e.role == "tip_level"):
                if comes_too_early(friction, place, base.model):
                    continue
                if not (whole.has(friction.name) or whole.lacks(friction)):
                    yield Candidate(transmission, place), Candidate(friction, place)


def _fit_both(search: LadderSearch, base: Fit, transmission: Candidate, friction: Candidate) -> Fit:
    """A rough fit of both effects, from draws."""
    coarse = base_of(base, search.prepared).coarse
    model = coarse.model
    for one in (transmission, friction):
        model = model.with_effect(one.effect, at=one.at)
    # where no draw leaves less than the base, the pair stays where it is absent
    starts = best_draws(model, search.prepared.coarse, coarse) or [model]
    new = (transmission.key, friction.key)
    return estimate_best_start(starts, new, search.prepared)


def _as_rungs(
    search: LadderSearch,
    base: Fit,
    transmission: Candidate,
    friction: Candidate,
    both: Fit,
    ranked_alone: Mapping[tuple[str, str], Fit],
) -> list[tuple[Rung, ...]]:
    """Two rungs: the transmission alone, and both effects; none where they are not separable.

    ranked_alone: fits of single candidates by their keys. A fit of the transmission that starts
        from the values of both effects may leave more than the base
    """
    alone = estimate_without(both.model, Rung(friction, both), search.prepared)
    if alone is None:
        return []
    alone = min((alone, ranked_alone.get(transmission.key, alone)), key=check_squares)
    rank = partial(make_ranked, prepared=search.prepared)
    # alone, a transmission explains little and may have no gap: it is judged together with friction
    first = replace(rank(base, transmission, both), fit=alone)
    rungs = (
        Rung(transmission, alone, Ranking(base, (first,))),
        Rung(friction, both, Ranking(alone, (rank(alone, friction, both),))),
    )
    return [rungs]


def _is_supported(
    search: LadderSearch, state: LadderState, base: Fit, pair: tuple[Rung, ...]
) -> bool:
    """Whether both effects are needed and plausible, and explain most of what the last rung leaves.

    Effects that were set aside are not supported again.
    """
    floor, both = state.floor, pair[-1].fit
    added = {rung.added.key for rung in pair if rung.added is not None}
    if added & state.gone:
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

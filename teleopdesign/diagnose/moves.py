"""Moves of a search over sets of effects: add one or two, remove one, or swap one for another.

A move takes a search and a state and returns the next state, or None where no such move is
supported. All moves are judged by the same gain on the check records (`decision.is_better`), with
the noise floor of the state. A move never leads to a set of effects where the search was before, so
that the search ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .candidates import Candidate, list_look_alikes
from .criteria import CRITERIA
from .decision import (
    alternatives_of,
    is_better,
    is_supported,
    look_alikes_of,
    select_equals,
    select_other_helpers,
    select_simplest,
    simplicity,
)
from .evidence import check_squares, explained_share, is_adequate, whole_score
from .fit import Fit, fit_squares
from .ladder_state import LadderSearch, LadderState
from .plausibility import undetermined_of
from .ranking import Ranked, Ranking
from .rung import Rung, estimate_without, make_replaced, order_by_falling_error, reorder_and_refit


def add(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with one more effect: the simplest that explains the records as well as the best.

    The effect may replace an effect of the user's model, or one that was added before. Effects that
    it makes superfluous are removed.
    """
    supported = list(state.supported)
    while supported:
        best = select_simplest(supported)
        moved = _add_candidate(search, state, best)
        if moved is not None and moved.effects not in state.visited:
            return _without_superfluous(search, state, moved)
        supported.remove(best)
    return None


def _add_candidate(search: LadderSearch, state: LadderState, best: Ranked) -> LadderState | None:
    alternatives = alternatives_of(best, state.ranking, state.fit, state.floor)
    noise = is_adequate(state.fit, state.floor)
    rung = Rung(
        best.candidate,
        best.fit,
        state.ranking,
        alternatives,
        replaced=make_replaced(best, state.fit.model),
        could_be=select_other_helpers(best, state.ranking) if noise else None,
    )
    rungs = [*state.rungs, rung]
    for i, earlier in enumerate(state.rungs[1:], 1):
        assert earlier.added is not None
        # both effects are in the model now: nothing is replaced
        if earlier.instead_of == best.candidate:
            rungs = [*state.rungs]
            rungs[i] = replace(earlier, replaced=None)
            break
        if best.instead_of == earlier.added:  # the earlier effect only imitated the new one
            rungs = [*state.rungs, replace(rung, replaced=earlier.replaced)]
            del rungs[i]
            break
    else:
        return state.with_rungs(rungs)
    return in_order(search, state, rungs, best.fit)


def add_two(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with two effects that the records support only together; only as the first move.

    Each of two effects may mask the other, so that neither is supported alone. The best candidates
    are followed (`SearchPlan.beam`), and all candidates at their body are ranked again beside each.
    """
    if state.step > 1 or is_adequate(state.fit, state.floor):
        return None
    first = [
        r
        for r in state.ranking.ranked
        if r.counts
        and r.candidate.key not in state.gone
        and fit_squares(r.fit) < fit_squares(state.fit)
        # all effects were ranked beside this effect before
        and frozenset(r.fit.model.effects) not in state.visited
    ]
    pairs = [_best_beside(search, state, one) for one in first[: search.plan.beam]]
    orders = [pair for pair in pairs if pair is not None]
    best = min(orders, key=lambda rungs: check_squares(rungs[-1].fit), default=None)
    return None if best is None else state.with_rungs(best)


def _best_beside(
    search: LadderSearch, state: LadderState, first: Ranked
) -> tuple[Rung, ...] | None:
    """The ladder with a candidate and the best one beside it; None where both are not needed."""
    here, floor = state.fit, state.floor
    # bodies do not act on each other along measured motions: effects of two never mask another
    body = here.model.holder(first.candidate.at)
    beside = search.rank(first.fit, step=state.step, body=body)
    second = next(
        (
            r
            for r in beside.ranked
            if r.candidate.key not in state.gone
            and r.instead_of != first.candidate
            and is_supported(first.fit, r, floor)
        ),
        None,
    )
    if second is None:
        return None
    rungs = (
        Rung(
            first.candidate,
            first.fit,
            state.ranking,
            look_alikes_of(first, state.ranking),
            replaced=make_replaced(first, here.model),
        ),
        Rung(
            second.candidate,
            second.fit,
            beside,
            alternatives_of(second, beside, first.fit, floor),
            replaced=make_replaced(second, first.fit.model),
        ),
    )
    if not _needs_both(search, state, rungs):
        return None
    return order_by_falling_error((*state.rungs, *rungs), search.prepared)


def _needs_both(search: LadderSearch, state: LadderState, pair: tuple[Rung, Rung]) -> bool:
    """Whether two effects together explain most of the missing force and both are needed."""
    here, both, floor = state.fit, pair[-1].fit, state.floor
    if (
        not is_better(here, both, floor)
        or explained_share(here, both, floor) < CRITERIA.mostly
        or not state.tone.is_beaten_by(both)
    ):
        return False
    without = estimate_without(both.model, pair[0], search.prepared)
    # None: the second effect needs the first
    return without is None or is_better(without, both, floor)


def _without_superfluous(
    search: LadderSearch, state: LadderState, moved: LadderState
) -> LadderState:
    """A state after a move, without one effect that the move made superfluous."""
    fewer = remove(search, moved)
    return moved if fewer is None or fewer.effects in state.visited else fewer


def remove(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Remove one effect that later effects made superfluous, and fit the others again."""
    for rung in state.rungs[1:-1]:
        without = estimate_without(state.fit.model, rung, search.prepared)
        if without is None or is_better(without, state.fit, state.floor):
            continue
        return in_order(search, state, [r for r in state.rungs if r is not rung], without)
    return None


def swap(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with another effect in the place of one that the records do not tell from it.

    Effects that explained the records equally well when one of them was added are compared again
    beside later effects: those that are no longer equal are dropped, and the best of the others
    takes the place of the accepted one, unless this is still as good.
    Over a part of a turn, a spring and the gravity of a link are nearly the same torque. Where only
    noise is left, the simpler of the two takes the place; where more is left, an unknown effect
    acts too, and may be as large as the difference of the two: then the commoner one does.
    So does a simpler effect that explains as much beside later ones, in the place of one of these,
    too: a spring and a constant force in that of gravity and what cancels its curvature.
    """
    for rung in state.rungs[1:]:
        assert rung.added is not None
        followed = _is_followed(rung, state)
        equals = rung.alternatives if followed else ()
        preferred = _list_preferred(search, state, rung.added)
        preferred += _list_simpler(rung, state) if followed else ()
        if rung.replaced is not None or not (equals or preferred):
            continue
        without = estimate_without(state.fit.model, rung, search.prepared)
        if without is None:
            continue
        among = (rung.added, *equals, *preferred)
        ranking = search.rank(without, step=state.step, among=among)
        ours = [None, *(r.added for r in state.rungs if r.added is not None)]
        supported = [
            r
            for r in ranking.ranked
            if r.instead_of in (ours if r.candidate in preferred else [None])
            and is_supported(without, r, state.floor)
        ]
        new = _in_place(search, state, rung, preferred, replace(ranking, ranked=tuple(supported)))
        if new is None:
            continue
        left = new.fit.model.effects
        rungs = [
            new if r is rung else r
            for r in state.rungs
            if r is rung or r.added is None or r.added.key in left
        ]
        moved = in_order(search, state, rungs, new.fit)
        if moved is not None and (new.added == rung.added or moved.effects not in state.visited):
            return _without_superfluous(search, state, moved)
    return None


def _in_place(
    search: LadderSearch,
    state: LadderState,
    rung: Rung,
    preferred: Sequence[Candidate],
    supported: Ranking,
) -> Rung | None:
    """The rung with another effect, or with fewer alternatives; None: it stays as it is.

    preferred: candidates that take the place where the records do not tell them from the effect
    supported: the effect, its alternatives and these, as far as the records support them
    """
    for r in supported.ranked:
        if r.candidate in preferred and whole_score(r.fit, state.fit) < CRITERIA.indistinguishable:
            return Rung(r.candidate, r.fit, supported)
    equal = [r for r in supported.ranked if r.candidate not in preferred]
    equal = select_equals(equal)
    if not 0 < len(equal) < 1 + len(rung.alternatives):
        return None
    kept = next((r for r in equal if r.candidate == rung.added), equal[0])
    others = tuple(r.candidate for r in equal if r is not kept)
    return replace(rung, added=kept.candidate, fit=kept.fit, alternatives=others)


def _list_preferred(
    search: LadderSearch, state: LadderState, added: Candidate
) -> tuple[Candidate, ...]:
    """Look-alikes that are preferred to an effect: simpler ones, or commoner ones.

    None where the file of the effect says that the motion tells it from them.
    """
    alike = [c for c in list_look_alikes(added, state.fit.model) if c.key not in state.gone]
    if is_adequate(state.fit, state.floor):
        alike = [c for c in alike if c.effect.commoner == added.effect.name]
        alike = [c for c in alike if simplicity(c) < simplicity(added)]
    else:
        alike = [c for c in alike if added.effect.commoner == c.effect.name]
    if alike and undetermined_of(added.effect, added.at, state.fit.model, search.prepared) is None:
        return ()
    return tuple(alike)


def _list_simpler(rung: Rung, state: LadderState) -> tuple[Candidate, ...]:
    """Effects of the same role with fewer parameters, which may do as much beside later effects.

    Of look-alikes the commoner one stays where more than noise is left.
    """
    noise = is_adequate(state.fit, state.floor)
    simpler = list_simpler_of_role(rung, state)
    name = rung.added.effect.name if rung.added is not None else ""
    return tuple(c for c in simpler if noise or c.effect.commoner != name)


def list_simpler_of_role(rung: Rung, state: LadderState) -> tuple[Candidate, ...]:
    """Effects of the same role with fewer parameters, which the model has not."""
    added = rung.added
    assert added is not None
    known = state.fit.model.known.values()
    possible = [Candidate(e, added.at) for e in known if e.role == added.effect.role]
    free = (c for c in possible if c.key not in state.gone | state.effects)
    return tuple(c for c in free if simplicity(c)[0] < simplicity(added)[0])


def _is_followed(rung: Rung, state: LadderState) -> bool:
    """Whether a rung was ranked without some of the other effects, which may change its place.

    The last rung only was so where an earlier one changed after it was added.
    """
    if rung is not state.rungs[-1]:
        return True
    return rung.ranking is not None and rung.ranking.base is not state.rungs[-2].fit


def in_order(
    search: LadderSearch, state: LadderState, rungs: Sequence[Rung], last: Fit
) -> LadderState | None:
    """The state with these rungs, ordered by falling error; None where there is no such order."""
    order = reorder_and_refit(rungs, last, search.prepared)
    return None if order is None else state.with_rungs(order)

"""A move of the ladder: many effects at once, then removal of those that are not needed.

If three effects are missing, a fourth effect may explain more than any of the three alone, and
block them at every step. For example, a drag with the square of the speed can imitate three effects
together: a friction that falls at low speed, a damper and a smaller drag. Adding all at once avoids
this.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ..base.errors import ModelError
from ..effects import period
from .adequacy import is_adequate
from .candidates import Candidate
from .decision import is_better
from .effort import EFFORTS
from .evidence import check_squares
from .fit import Fit, estimate
from .ladder_state import LadderSearch, LadderState
from .order import alternatives_of
from .outside_tone import best_tone
from .plausibility import implausible_effects
from .ranking import Ranked, Ranking
from .rung import Rung
from .rungs import estimate_without, reorder_and_refit
from .search_plan import PLAN
from .verdict import explained_share


def add_together(search: LadderSearch, state: LadderState) -> LadderState | None:
    """Replace all rungs by the best candidates, added to the user's model at once.

    This happens once, where more than noise is left. Each effect must be needed and plausible, and
    together they must explain most of the squares that the rungs leave.
    returns: None where this fails
    """
    if state.together or is_adequate(state.fit, state.floor, criteria=search.criteria):
        return None
    ranking = state.rungs[1].ranking if state.step > 1 else state.ranking
    if ranking is None:
        return None
    chosen = _select(search, state, ranking)
    if len(chosen) < 2:
        return None
    search.progress(f"trying {len(chosen)} effects at once")
    whole = _fit_all(search, state.rungs[0].fit, chosen)
    fit, needed = _take_out_superfluous(search, state, whole, [r.candidate for r in chosen])
    if not _is_supported(search, state, fit, needed):
        return None
    rungs = (state.rungs[0], *(Rung(one, fit, ranking) for one in needed))
    order = reorder_and_refit(rungs, estimate(fit.model, search.prepared), search.prepared)
    if order is None or frozenset(order[-1].fit.model.effects) in state.visited:
        return None
    ranked = _rank_each(search, state, order, ranking)
    return replace(state.with_rungs(ranked), together=True, replaced=True)


def _select(search: LadderSearch, state: LadderState, ranking: Ranking) -> list[Ranked]:
    """The best candidates without hidden states, structure, actuation or period.

    They need not be identifiable alone. Of two that leave exactly as much, such as a bias and an
    asymmetry, only the first is selected.
    """
    gone = {one.candidate.key for one in state.set_aside}
    chosen: list[Ranked] = []
    for ranked in ranking.ranked:
        effect = ranked.candidate.effect
        if len(chosen) == search.plan.together:
            break
        if effect.states or effect.role in ("structure", "actuation") or period(effect):
            continue
        if ranked.refused or ranked.implausible or ranked.candidate.key in gone:
            continue
        if check_squares(ranked.fit) >= check_squares(ranking.base):
            continue
        if not any(_leave_the_same(ranked.fit, other.fit) for other in chosen):
            chosen.append(ranked)
    return chosen


def _leave_the_same(one: Fit, other: Fit) -> bool:
    squares, others = check_squares(one), check_squares(other)
    return squares == others or abs(squares - others) < PLAN.same * others


def _fit_all(search: LadderSearch, base: Fit, chosen: Sequence[Ranked]) -> Fit:
    """A rough fit of the base's model with all these effects, each from its values alone."""
    model = base.model
    for ranked in chosen:
        name, at = ranked.candidate.key
        start = f"{at}.{name}."
        try:
            model = model.with_effect(ranked.candidate.effect, at=at)
        except ModelError:  # the body has an effect of this kind already
            continue
        alone = ranked.fit.model.parameters
        model = model.with_values({n: v.value for n, v in alone.items() if n.startswith(start)})
    return estimate(model, search.prepared, effort=EFFORTS.rough)


def _take_out_superfluous(
    search: LadderSearch, state: LadderState, whole: Fit, added: list[Candidate]
) -> tuple[Fit, list[Candidate]]:
    """The fit without superfluous effects, and the effects that stay.

    Effects are removed in turn, the least certain first, until the fit becomes surely worse.
    """
    fit, there = whole, [one for one in added if whole.model.body(one.at).has(one.effect.name)]
    while there:
        weakest = min(there, key=lambda one: _sureness(fit, one))
        without = estimate_without(fit.model, Rung(weakest, fit), search.prepared)
        if without is None or is_better(without, fit, state.floor, criteria=search.criteria):
            break
        fit, there = without, [one for one in there if one is not weakest]
    return fit, there


def _sureness(fit: Fit, candidate: Candidate) -> float:
    """Largest number of standard errors by which a strength differs from absence."""
    names = [f"{candidate.at}.{candidate.effect.name}.{n}" for n in candidate.effect.absent]
    away = [
        fit.model.from_absence(n) / fit.model.parameters[n].stderr
        for n in names
        if n in fit.free and fit.model.parameters[n].stderr > 0.0
    ]
    return max((a for a in away if np.isfinite(a)), default=0.0)


def _is_supported(
    search: LadderSearch, state: LadderState, fit: Fit, needed: Sequence[Candidate]
) -> bool:
    """Whether at least two effects stay, each needed and plausible, and together explain most."""
    criteria, floor, prepared = search.criteria, state.floor, search.prepared
    if len(needed) < 2 or not is_better(state.fit, fit, floor, criteria=criteria):
        return False
    if explained_share(state.fit, fit, floor) < criteria.mostly:
        return False
    if set(implausible_effects(fit.model, prepared)) & {one.key for one in needed}:
        return False
    if not best_tone(state.rungs[0].fit, prepared).is_beaten_by(fit):
        return False
    lacking = (estimate_without(fit.model, Rung(one, fit), prepared) for one in needed)
    return all(
        without is None or is_better(without, fit, floor, criteria=criteria) for without in lacking
    )


def _rank_each(
    search: LadderSearch, state: LadderState, order: Sequence[Rung], first: Ranking
) -> tuple[Rung, ...]:
    """The rungs with rankings: each effect is ranked beside the rung before it.

    Effects that left exactly as much beside the user's model are ranked with it.

    first: all candidates beside the user's model
    """
    squares = {r.candidate.key: check_squares(r.fit) for r in first.ranked}
    there = {rung.added.key for rung in order if rung.added is not None}
    ranked = [order[0]]
    for step, (before, rung) in enumerate(pairwise(order), 1):
        assert rung.added is not None
        left = squares[rung.added.key]
        twins = [
            r.candidate
            for r in first.ranked
            if r.candidate.key not in there
            and abs(squares[r.candidate.key] / left - 1.0) < PLAN.same
        ]
        ranking = search.rank(before.fit, step=step, among=[rung.added, *twins])
        (same,) = (r for r in ranking.ranked if r.candidate.key == rung.added.key)
        alternatives = alternatives_of(
            same, ranking, before.fit, state.floor, criteria=search.criteria
        )
        ranked.append(replace(rung, ranking=ranking, alternatives=alternatives))
    return tuple(ranked)

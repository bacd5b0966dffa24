"""Forces of position in a ladder: a straight line instead of two curved forces that cancel.

A cable, a bushing and a constant load together are a force linear in position: `spring` and `bias`.
A ladder adds one effect at a time. A curved force with two parameters, such as `gravity` over a
part of a turn, explains more than either of the two alone, and the next effect then cancels its
curvature. At the end of a ladder its forces of position are compared with a straight line.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import sympy as sp

from ..base.errors import ModelError
from ..effects import SIGNALS, Effect, period
from ..measurement.prepare import Prepared
from ..model import Model
from .candidates import Candidate
from .decision import is_better
from .fit import Fit, estimate
from .ladder_state import LadderSearch, LadderState
from .moves import remove
from .plausibility import is_of_place
from .rung import Rung
from .rungs import estimate_without, ranking_alone, reorder_and_refit, without_rise
from .search import keep_absent


def straighten(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with a straight line for curved forces of position; None: the curved ones stay.

    The line replaces effects with more parameters unless these are surely better, and effects with
    as many or fewer parameters if the line is surely better.
    """
    for bent in _bent_rungs(state):
        moved = _with_line(search, state, bent)
        if moved is not None:
            return remove(search, moved) or moved
    return None


def _bent_rungs(state: LadderState) -> Iterator[tuple[Rung, ...]]:
    """Groups of accepted curved forces of one body's position, the largest groups first."""
    bent = [r for r in state.rungs if r.added is not None and is_bent(r.added.effect)]
    for count in range(len(bent), 0, -1):
        for some in combinations(bent, count):
            if len({r.added.at for r in some if r.added is not None}) == 1:
                yield some


def _with_line(
    search: LadderSearch, state: LadderState, bent: Sequence[Rung]
) -> LadderState | None:
    """The ladder with a line in place of these rungs; None where the line is not preferred."""
    (at,) = {r.added.at for r in bent if r.added is not None}
    body = state.fit.model.body(at)
    straight = (e for e in state.fit.model.known.values() if is_straight(e))
    gone = {one.candidate.key for one in state.set_aside}
    line = [Candidate(e, at) for e in straight if not (body.has(e.name) or body.lacks(e))]
    # without the curved laws, the effects that they replaced return
    back = [r.instead_of for r in bent if r.instead_of is not None]
    line = [c for c in line if c.key not in gone | {one.key for one in back}]
    saved = sum(_count_required(r.added.effect) for r in bent if r.added is not None)
    saved -= len(line) + sum(_count_required(one.effect) for one in back)
    if not line:
        return None
    fit = _exchange_for_line(state.fit.model, bent, line, search)
    if fit is None:
        return None
    floor = state.floor
    if saved > 0:
        as_good = not is_better(fit, state.fit, floor)
    else:
        as_good = is_better(state.fit, fit, floor)
    if not as_good:
        return None
    first = next(i for i, r in enumerate(state.rungs) if r is bent[0])
    before, after = state.rungs[:first], state.rungs[first:]
    rungs = (*before, *_line_rungs(before[-1].fit, line, search))
    others = [r for r in after if all(r is not b for b in bent)]
    if others:
        order = reorder_and_refit((*rungs, *others), fit, search.prepared)
    else:
        order = without_rise((*rungs[:-1], replace(rungs[-1], fit=fit)))
    if order is None or order[-1].fit is not fit:
        return None
    moved = state.with_rungs(order)
    return None if moved.effects in state.visited else moved


def _exchange_for_line(
    model: Model, bent: Sequence[Rung], line: Sequence[Candidate], search: LadderSearch
) -> Fit | None:
    """The fit with the line and without the curved forces; None: these cannot be removed."""
    try:
        for rung in bent:
            model = rung.undo_addition(model)
    except ModelError:
        return None
    for candidate in line:
        model = model.with_effect(candidate.effect, at=candidate.at)
    return estimate(model, search.prepared)


def _line_rungs(base: Fit, line: Sequence[Candidate], search: LadderSearch) -> list[Rung]:
    """A rung for each part of the line, the part with the least check error first.

    A part that explains nothing by itself stays at zero: far from its rest position, a spring does
    next to nothing without the constant force that moves this position. What it explains is judged
    beside the other part.
    """
    prepared = search.prepared
    rungs: list[Rung] = []
    left = list(line)
    while left:
        models = [base.model.with_effect(c.effect, at=c.at) for c in left]
        fits = [estimate(model, prepared) for model in models]
        best = min(range(len(left)), key=lambda i: fits[i].check_error)
        fit = fits[best]
        if fit.check_error > base.check_error:
            fit = keep_absent(models[best], base)
        ranking = ranking_alone(base, left[best], fit, prepared)
        rungs.append(Rung(left.pop(best), fit, ranking))
        base = fit
    return [_judge_beside(r, base, prepared) if r is not rungs[-1] else r for r in rungs]


def _judge_beside(rung: Rung, line: Fit, prepared: Prepared) -> Rung:
    """The rung of a part of the line, with its evidence from the line with and without it."""
    without = estimate_without(line.model, rung, prepared)
    if rung.added is None or without is None:
        return rung
    return replace(rung, ranking=ranking_alone(without, rung.added, line, prepared))


def is_straight(effect: Effect) -> bool:
    """Whether a force of one parameter is linear in position; a constant force is, too."""
    if not is_of_place(effect) or len(effect.parameters) != 1 or effect.strength is None:
        return False
    return bool(sp.diff(effect.expression(), SIGNALS["position"], 2) == 0)


def is_bent(effect: Effect) -> bool:
    """Whether a force of position is not linear, and has no period of free length."""
    if not is_of_place(effect) or isinstance(period(effect), str):
        return False
    return bool(sp.diff(effect.expression(), SIGNALS["position"], 2) != 0)


def _count_required(effect: Effect) -> int:
    """Number of parameters that must be estimated."""
    return sum(not p.optional for p in effect.parameters.values())

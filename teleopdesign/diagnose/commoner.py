"""Spring or gravity: the effect that is more common, where the records hardly distinguish the two.

Over a part of a turn, a spring and the gravity of a link are nearly the same torque. If the
remaining error is noise, either the records distinguish the two, or the simpler effect is named. If
more than noise remains, an unknown effect acts too, and may be as large as the difference of the
two effects. Then a smaller error, or one parameter less, is weak evidence, and the effect that most
machines have is named. The file of an effect says which effect is more common (`commoner`), and on
which travel the two are hardly distinguished (`undetermined`).
"""

from __future__ import annotations

from .adequacy import is_adequate
from .candidates import Candidate, list_look_alikes
from .decision import is_supported
from .evidence import whole_score
from .ladder_state import LadderSearch, LadderState
from .moves import remove
from .order import simplicity
from .plausibility import undetermined_of
from .ranking import Ranking
from .rung import Rung
from .rungs import estimate_without, reorder_and_refit


def compare_look_alikes(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with one effect replaced by another that the records hardly distinguish from it.

    Where more than noise is left, the more common effect is preferred, such as gravity to a spring;
    where only noise is left, the simpler one.
    returns: None where the records distinguish the effects, or the preferred ones are present
        already
    """
    noise = is_adequate(state.fit, state.floor, criteria=search.criteria)
    for rung in state.rungs[1:]:
        assert rung.added is not None
        for other in _list_rivals(rung.added, state, simpler=noise):
            moved = _exchange_for(search, state, rung, other)
            if moved is not None and moved.effects not in state.visited:
                return moved
    return None


def _list_rivals(added: Candidate, state: LadderState, *, simpler: bool) -> list[Candidate]:
    """Look-alikes that may replace an effect: the simpler ones, or else the more common ones."""
    alike = [c for c in list_look_alikes(added, state.fit.model) if c.key not in state.gone]
    if simpler:
        return [
            c
            for c in alike
            if c.effect.commoner == added.effect.name and simplicity(c) < simplicity(added)
        ]
    return [c for c in alike if added.effect.commoner == c.effect.name]


def _exchange_for(
    search: LadderSearch, state: LadderState, rung: Rung, other: Candidate
) -> LadderState | None:
    """The ladder with a look-alike in place of a rung's effect; None: it is not supported."""
    model, criteria, added = state.fit.model, search.criteria, rung.added
    assert added is not None
    if (
        rung.replaced is not None
        or undetermined_of(added.effect, added.at, model, search.prepared) is None
    ):
        return None
    without = estimate_without(model, rung, search.prepared)
    if without is None:
        return None
    ranking: Ranking = search.rank(without, step=state.step, among=(other, added))
    best = next((r for r in ranking.ranked if r.candidate.key == other.key), None)
    if (
        best is None  # the other effect is no candidate with these motions
        or best.instead_of is not None
        or not is_supported(without, best, state.floor, criteria=criteria)
        or whole_score(best.fit, state.fit) >= criteria.close
    ):
        return None
    new = Rung(other, best.fit, ranking)
    rungs = [new if r is rung else r for r in state.rungs]
    order = reorder_and_refit(rungs, best.fit, search.prepared)
    if order is None:
        return None
    moved = state.with_rungs(order)
    return remove(search, moved) or moved

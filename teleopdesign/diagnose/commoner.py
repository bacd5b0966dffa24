"""Spring or gravity: the effect that is more common, where the records hardly distinguish the two.

Over a part of a turn, a spring and the gravity of a link are nearly the same torque. If the
remaining error is noise, either the records distinguish the two, or the simpler effect is named. If
more than noise remains, something unknown acts too, and may be as large as the difference of the
two effects. Then a smaller error, or one parameter less, says little, and the effect that most
machines have is named. The file of an effect says which effect is more common (`commoner`), and on
which travel the two are hardly distinguished (`untold`).
"""

from __future__ import annotations

from .adequacy import is_adequate
from .candidates import Candidate
from .decision import is_supported
from .evidence import whole_score
from .ladder_state import LadderSearch, LadderState
from .moves import remove
from .plausibility import untold_of
from .ranking import Ranking
from .rung import Rung
from .rungs import estimate_without, reorder_and_refit


def name_commoner(search: LadderSearch, state: LadderState) -> LadderState | None:
    """The ladder with a commoner effect in the place of one that the records do not tell from it.

    None: noise is left, or the records tell all accepted effects from commoner ones.
    """
    if is_adequate(state.fit, state.floor, criteria=search.criteria):
        return None
    for rung in state.rungs[1:]:
        moved = _with_commoner(search, state, rung)
        if moved is not None and moved.effects not in state.visited:
            return moved
    return None


def _with_commoner(search: LadderSearch, state: LadderState, rung: Rung) -> LadderState | None:
    """The ladder with the commoner effect in the place of a rung's; None: not supported there."""
    model, criteria, added = state.fit.model, search.criteria, rung.added
    assert added is not None
    commoner = model.known.get(added.effect.commoner)
    if commoner is None or rung.replaced is not None or model.body(added.at).has(commoner.name):
        return None
    other = Candidate(commoner, added.at)
    untold = untold_of(added.effect, added.at, model, search.prepared)
    if untold is None or other.key in state.gone:
        return None
    without = estimate_without(model, rung, search.prepared)
    if without is None:
        return None
    ranking: Ranking = search.rank(without, step=state.step, among=(other, added))
    best = next((r for r in ranking.ranked if r.candidate.key == other.key), None)
    if (
        best is None  # its law does not hold on this axis
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

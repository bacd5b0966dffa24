"""Exchange: an accepted effect gives way to one that explains the records better beside the rest.

Effects are added one at a time, so an early one may only stand in for what was not there yet. Where
more than noise is left in the end, each of those that others followed is taken out once, and the
rivals that it beat when it was added are ranked in its place.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from ..errors import ModelError
from ..model import Model
from .candidates import Candidate
from .fit import Fit, estimate
from .force_error import Prepared
from .noise_floor import NoiseFloor
from .rank import Ranked, Ranking, check_squares, rank_candidates
from .support import is_better, is_supported


@dataclass(frozen=True)
class Exchange:
    """One effect for another.

    dropped: the one that gives way;  without: the fit that both are compared on
    taken: the one in its place, with the model fitted with it;  ranking: all that were tried there
    """

    dropped: Candidate
    without: Fit
    taken: Ranked
    ranking: Ranking


def rivals_of(ranking: Ranking, there: Collection[Candidate], floor: NoiseFloor) -> list[Candidate]:
    """What the records supported in a ranking besides the one that was added, and is not there."""
    keys = {c.key for c in there}
    supported = [r.candidate for r in ranking.ranked if is_supported(ranking.base, r, floor)]
    return [c for c in supported if c.key not in keys]


def best_exchange(
    found: Fit,
    rivals: Mapping[Candidate, Collection[Candidate]],
    prepared: Prepared,
    floor: NoiseFloor,
    *,
    stated: Model | None = None,
    progress: Callable[[str], None] | None = None,
) -> Exchange | None:
    """The exchange that lowers the error on the check records most; None where none does clearly.

    found: the fit with all that was accepted;  rivals: accepted effect -> what may take its place
    stated, progress: as for `rank_candidates`
    """
    exchanges = []
    for dropped, among in rivals.items():
        if not among:
            continue
        name, at = dropped.key
        try:
            without = estimate(found.model.without_effect(name, at=at), prepared)
        except ModelError:
            continue  # another effect needs it
        ranking = rank_candidates(without, prepared, among=among, stated=stated, progress=progress)
        better = [
            r
            for r in ranking.ranked
            if is_supported(without, r, floor) and is_better(found, r.fit, floor)
        ]
        if better:
            taken = min(better, key=lambda r: check_squares(r.fit))
            exchanges.append(Exchange(dropped, without, taken, ranking))
    return min(exchanges, key=lambda e: check_squares(e.taken.fit), default=None)

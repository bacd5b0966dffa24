"""Fits and rankings that several tests ask for, made once for the same objects."""

from contextlib import contextmanager
from functools import cache

import pytest

from teleopdesign.diagnose import ladder_state
from teleopdesign.diagnose.search import estimate_from_starts


@cache
def fit_beside(prepared, before, candidate):
    """The fit with one effect more than `before`."""
    model = before.model.with_effect(candidate.effect, at=candidate.at)
    return estimate_from_starts(model, prepared, before)


@contextmanager
def each_ranking_once():
    """What a ranking depends on is in its arguments: moves that ask for the same one share it."""
    rank, kept = ladder_state.rank_candidates, {}

    def remember(base, prepared, *, among, stated, progress, **rest):
        whose = (base, prepared, stated)
        key = (*map(id, whose), among and frozenset(among), *sorted(rest.items()))
        if key not in kept:  # beside what it was made of, so that no new object has the same id
            of = {"among": among, "stated": stated, "progress": progress}
            kept[key] = whose, rank(base, prepared, **of, **rest)
        return kept[key][1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ladder_state, "rank_candidates", remember)
        yield

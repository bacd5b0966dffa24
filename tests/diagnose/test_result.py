"""What a search states at its end: each candidate at each step, look-alikes, no state of it."""

import pickle
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.base.frozen import is_same
from teleopdesign.diagnose import result
from teleopdesign.diagnose.fit import Fit
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.diagnose.result import diagnosis_of


def test_a_candidate_has_on_each_step_the_errors_of_its_fit_there(end, diagnosis):
    rows = {c.candidate.key: c for c in diagnosis.candidates}
    rankings = [end.rungs[1].ranking, end.last]
    for step, ranking in enumerate(rankings):
        for ranked in ranking.ranked:
            stated = rows[ranked.candidate.key].steps[step]
            assert stated.score == ranked.score
            if stated.outcome != "added":
                assert stated.check_error == ranked.fit.check_error
    assert rows["stribeck", "device"].steps[0].check_error == end.rungs[1].fit.check_error
    assert all(len(r.steps) == len(rankings) for r in rows.values())


def outcome(end, rung=None, **changes):
    """Of the best candidate of the first step, that counts and has no parameter at a bound."""
    ranking = end.rungs[1].ranking
    best = replace(ranking.best, is_identifiable=True, refused="", implausible="")
    best = replace(best, fit=replace(best.fit, at_bound=ranking.base.at_bound))
    return result._outcome(rung, ranking.base, replace(best, **changes))


def test_what_became_of_a_candidate_is_reported_where_its_error_does_not_show_it(end):
    rung = end.rungs[1]
    ranked, other = rung.ranking.best, rung.ranking.ranked[1].candidate
    candidate, bounds = ranked.candidate, rung.ranking.base.at_bound
    assert outcome(end) == ""
    assert outcome(end, replace(rung, added=candidate)) == "added"
    assert outcome(end, replace(rung, added=other, alternatives=(candidate,))) == "as good"
    assert outcome(end, replace(rung, added=other, alternatives=())) == ""
    assert outcome(end, replace(rung, added=None, alternatives=())) == ""
    assert outcome(end, refused="blind", implausible="it is none") == "blind"
    assert outcome(end, implausible="it is none", is_identifiable=False) == "implausible"
    assert outcome(end, is_identifiable=False) == "open"
    at_bound = replace(ranked.fit, at_bound=(*bounds, "device.inertia"))
    assert outcome(end, fit=at_bound) == "displaces"
    idle = [r for r in end.last.ranked if r.candidate.key in r.fit.model.absent]
    assert {result._outcome(None, end.last.base, r) for r in idle} == {"no gain"}


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_the_likeness_of_two_candidates_is_a_correlation_at_any_size(size):
    def leaves(*residual):
        return SimpleNamespace(check_residual=size * np.array(residual))

    base = leaves(0.0, 0.0, 0.0)
    one, other = (leaves(*r) for r in ((1.0, 2.0, 0.0), (2.0, 1.0, 0.0)))
    assert result._likeness(base, one, other) == pytest.approx(0.8)
    assert np.isnan(result._likeness(base, one, base))


def test_a_look_alike_comes_with_its_distance_from_the_accepted_effect(end):
    rung = end.rungs[1]
    first, second = rung.ranking.ranked[:2]
    names = ("check_error", "fit_residual", "check_residual")
    same = replace(second, fit=replace(second.fit, **{n: getattr(first.fit, n) for n in names}))
    ranking = replace(rung.ranking, ranked=(first, same))
    alike = replace(rung, ranking=ranking, alternatives=(same.candidate,))
    stated = diagnosis_of(replace(end, rungs=(end.rungs[0], alike)))
    (other,) = stated.rungs[1].alternatives
    assert other.candidate == same.candidate and other.check_error == first.fit.check_error
    assert other.likeness == pytest.approx(1.0) and other.apart == 0.0
    assert stated.groups == ((rung.added, same.candidate),) == stated.indistinguishable


def parts_of(thing, parts=None):
    """Every object within a result, those of its recording left out."""
    parts = {} if parts is None else parts
    if id(thing) in parts or isinstance(thing, str | bytes | int | float | np.ndarray):
        return parts
    parts[id(thing)] = thing
    if isinstance(thing, dict):
        inner = [*thing.values()]
    elif isinstance(thing, list | tuple):
        inner = [*thing]
    else:
        inner = [v for n, v in getattr(thing, "__dict__", {}).items() if n != "recording"]
    for one in inner:
        parts_of(one, parts)
    return parts


def test_a_diagnosis_holds_no_state_of_its_search(end):
    stated = diagnosis_of(end)
    kinds = {type(one) for one in parts_of(stated).values()}
    assert not kinds & {Fit, Ranking}
    assert is_same(pickle.loads(pickle.dumps(stated)), stated)

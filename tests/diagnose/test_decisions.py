"""What a search decides of the fits that it has: its noise floor, its way, and which look alike."""

from dataclasses import replace

import pytest

from teleopdesign.diagnose.evidence import limit_noise_floor
from teleopdesign.diagnose.moves import add
from teleopdesign.diagnose.probability import verdict
from teleopdesign.effects import EFFECTS, are_alike


def test_a_floor_is_no_more_than_the_records_leave(first):
    """A jitter of the clock is told by the readings: then no candidate limits the floor."""
    high = replace(first.floor, value=10.0, jitters=False)
    least = min(r.fit.check_error for r in first.ranking.ranked if r.counts)
    assert limit_noise_floor(high, first.fit, first.ranking).value == least < first.fit.check_error
    jittering = limit_noise_floor(replace(high, jitters=True), first.fit, first.ranking)
    assert jittering.value == first.fit.check_error


def test_no_move_leads_to_a_set_of_effects_where_the_search_was_before(search, first):
    moved = add(search, first)
    assert moved is not None and ("stribeck", "device") in moved.effects
    again = add(search, replace(first, visited=first.visited | {moved.effects}))
    assert again is None or again.effects != moved.effects


def test_effects_are_missing_unless_each_of_them_has_an_equal(end):
    before, added = end.rungs
    assert verdict(end.rungs, end.floor) == "effects_missing"
    equal = replace(added, alternatives=(end.rungs[1].ranking.ranked[1],))
    assert verdict((before, equal), end.floor) == "undecided"
    assert verdict((before, equal, added), end.floor) == "effects_missing"


@pytest.mark.parametrize("name", sorted(n for n, e in EFFECTS.items() if e.commoner))
def test_an_effect_and_its_commoner_one_look_alike_and_the_rarer_says_where(name):
    rarer, commoner = EFFECTS[name], EFFECTS[EFFECTS[name].commoner]
    assert are_alike(rarer, commoner) and are_alike(commoner, rarer)
    assert rarer.undetermined is not None and rarer.role == commoner.role
    assert commoner.commoner != name, "one of the two is the commoner one"

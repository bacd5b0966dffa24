"""Rungs stand in an order in which the error falls, each fitted without what comes later."""

from dataclasses import replace
from itertools import pairwise, permutations
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose.stub_models import Table, candidate

from teleopdesign.diagnose import rungs as module
from teleopdesign.diagnose.rung import Rung
from teleopdesign.diagnose.rungs import (
    estimate_without,
    first_rise,
    order_by_falling_error,
    reorder_and_refit,
    without_rise,
)

NAMES = ("bias", "spring", "viscous", "cogging")


def stated(errors, needs=()):
    """A table of these sets of effects."""
    return Table({frozenset(names): e for names, e in errors.items()}.__getitem__, tuple(needs))


def names_of(rungs):
    return [r.added.effect.name for r in rungs[1:]]


@pytest.fixture
def estimated(monkeypatch):
    """Fits are looked up in a table; a ranking holds what it was made of."""

    def use(table):
        monkeypatch.setattr(module, "estimate", table.estimate)
        monkeypatch.setattr(
            module,
            "estimate_from_starts",
            lambda model, prepared, base, *, worth: table.estimate(model, prepared),
        )
        monkeypatch.setattr(
            module,
            "make_ranked",
            lambda base, candidate, fit, *, prepared, instead_of=None: SimpleNamespace(
                candidate=candidate, fit=fit, instead_of=instead_of
            ),
        )

    return use


def random_table(seed, count):
    """Errors of all sets of effects: each takes away a part, some only beside others."""
    rng = np.random.default_rng(seed)
    sets = {frozenset(s) for k in range(count + 1) for s in permutations(NAMES[:count], k)}
    errors = {s: rng.uniform(0.9, 1.1) * 0.8 ** len(s) for s in sorted(sets, key=sorted)}
    return Table(errors.__getitem__)


def check_ladder(order, table, names):
    """What every ladder is: all effects once, falling errors, each fit without the later ones."""
    assert sorted(names_of(order)) == sorted(names)
    for before, after in pairwise(order):
        assert after.fit.check_error <= before.fit.check_error
    for k, rung in enumerate(order):
        there = frozenset(names_of(order[: k + 1]))
        assert rung.fit.model.names == there
        assert rung.fit.check_error == table.error(there)


def errors(*values):
    return [SimpleNamespace(fit=SimpleNamespace(check_error=v)) for v in values]


def test_a_ladder_rises_where_a_rung_leaves_more_not_where_it_leaves_as_much():
    assert first_rise(errors(3.0, 2.0, 2.0, 1.0)) is None
    assert first_rise(errors(3.0, 3.1, 2.0)) == 1
    assert first_rise(errors(3.0, 2.0, 2.1, 2.2)) == 2
    assert first_rise(errors(3.0)) is None
    rungs = errors(3.0, 2.0, 2.1, 1.0)
    assert without_rise(rungs) == tuple(rungs[:2])
    assert without_rise(rungs[:2]) == tuple(rungs[:2])


@pytest.mark.parametrize("seed", range(40))
def test_an_order_that_comes_out_falls_and_holds_all_effects(seed, estimated):
    count = 2 + seed % 3
    table = random_table(seed, count)
    estimated(table)
    rungs = table.rungs(*NAMES[:count])
    order = reorder_and_refit(rungs, rungs[-1].fit, None)
    if order is not None:
        check_ladder(order, table, NAMES[:count])
        assert order[0] is rungs[0] and order[-1].fit.model == rungs[-1].fit.model
    if first_rise(rungs) is None:
        assert names_of(order) == names_of(rungs), "what falls already stays as it is"


@pytest.mark.parametrize("first", [0.9, 1.1])
@pytest.mark.parametrize("second", [0.9, 1.1])
def test_of_two_effects_the_one_that_helps_alone_comes_first(first, second, estimated):
    table = stated({(): 1.0, ("bias",): first, ("spring",): second, ("bias", "spring"): 0.5})
    estimated(table)
    order = order_by_falling_error(table.rungs("bias", "spring"), None)
    if first > 1.0 and second > 1.0:
        assert order is None
    else:
        check_ladder(order, table, ["bias", "spring"])
        assert names_of(order)[0] == ("bias" if first < 1.0 else "spring")


def test_a_masked_rung_changes_places_with_the_next_wherever_it_stands(estimated):
    table = stated(
        {
            (): 1.0,
            ("bias",): 0.8,
            ("bias", "spring"): 0.85,
            ("bias", "viscous"): 0.7,
            ("bias", "spring", "viscous"): 0.4,
            NAMES: 0.3,
        }
    )
    estimated(table)
    rungs = table.rungs(*NAMES)
    order = order_by_falling_error(rungs, None)
    check_ladder(order, table, NAMES)
    assert names_of(order) == ["bias", "viscous", "spring", "cogging"]
    assert order[:2] == rungs[:2] and order[-1] is rungs[-1]
    # each of the two is ranked beside what stands before it now
    for before, rung in pairwise(order[1:4]):
        assert rung.ranking.base is before.fit
        assert rung.ranking.best.candidate == rung.added and rung.ranking.best.fit is rung.fit


def test_a_rung_that_changes_its_place_keeps_its_look_alikes(estimated):
    table = stated(
        {(): 1.0, ("bias",): 1.1, ("spring",): 0.8, ("bias", "spring"): 0.5, ("viscous",): 0.9}
        | {("cogging",): 1.0, ("spring", "cogging"): 0.5}
    )
    estimated(table)
    rungs = table.rungs("bias", "spring")
    likes = {"bias": (candidate("cogging"),), "spring": (candidate("viscous"),)}
    rungs = [
        r if r.added is None else replace(r, alternatives=likes[r.added.effect.name]) for r in rungs
    ]
    order = order_by_falling_error(rungs, None)
    assert names_of(order) == ["spring", "bias"]
    for rung in order[1:]:
        (other,) = likes[rung.added.effect.name]
        assert rung.alternatives == (other,)
        assert [r.candidate for r in rung.ranking.ranked] == [rung.added, other]


def test_a_last_rung_that_leaves_more_has_no_order(estimated):
    table = stated({(): 1.0, ("bias",): 0.5, ("bias", "spring"): 0.6, ("spring",): 0.9})
    estimated(table)
    assert order_by_falling_error(table.rungs("bias", "spring"), None) is None


def test_an_effect_never_comes_before_what_it_needs(estimated):
    needs = [("spring", "bias")]  # as if a spring were not there without a bias
    table = stated({(): 1.0, ("bias",): 1.1, ("bias", "spring"): 0.5}, needs)
    estimated(table)
    rungs = table.rungs("bias", "spring")
    assert order_by_falling_error(rungs, None) is None
    assert estimate_without(rungs[-1].fit.model, rungs[1], None) is None
    assert estimate_without(rungs[-1].fit.model, rungs[2], None).check_error == 1.1
    # nor is it fitted before it
    wrong = (rungs[0], rungs[2], rungs[1])
    assert reorder_and_refit(wrong, rungs[-1].fit, None) is None


def test_the_last_fit_and_the_users_model_stay_as_they_are(estimated):
    table = stated({(): 1.0, ("bias",): 0.5})
    estimated(table)
    one, rung = table.rungs("bias")
    assert reorder_and_refit((one,), rung.fit, None) == (one,)
    moved = reorder_and_refit((one, Rung(candidate("bias"), table.fit())), rung.fit, None)
    assert moved[0] is one and moved[-1].fit is rung.fit

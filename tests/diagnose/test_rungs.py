"""Rungs stand in an order in which the error falls, each fitted without what comes later."""

from itertools import pairwise, permutations
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose.stub_models import Table

from teleopdesign.diagnose import rung as module
from teleopdesign.diagnose.rung import first_rise, order_by_falling_error, reorder_and_refit

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

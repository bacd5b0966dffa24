"""What is added and removed, where each set of effects leaves a stated error."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.stand_ins import SHAPE
from diagnose.stub_models import Names, Table, candidate

from teleopdesign.diagnose import rung as rungs_module
from teleopdesign.diagnose.moves import add, add_two
from teleopdesign.diagnose.outside_tone import Tone
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.diagnose.search_plan import PLAN

SPRING, HARD, BIAS, DRAG, GRAVITY = map(
    candidate, ("spring", "hardening_spring", "bias", "quadratic_drag", "gravity")
)


@pytest.fixture
def use(monkeypatch):
    """A table by which everything is estimated."""

    def with_rule(rule, **more):
        table = Table(rule, **more)
        monkeypatch.setattr(rungs_module, "estimate", table.estimate)
        alone = lambda base, c, fit, *, prepared, instead_of: table.rank(base, among=[c]).best  # noqa: E731
        monkeypatch.setattr(rungs_module, "make_ranked", alone)
        return table

    return with_rule


def shares(**parts):
    """Each effect takes away that much of the error of one."""
    return lambda names: 1.0 - sum(parts.get(n, 0.0) for n in names)


def names(state):
    return [r.added.effect.name for r in state.rungs[1:]]


def looked(table, state, *among, **more):
    """The state with these candidates ranked beside its last rung, all of them supported."""
    ranking = table.rank(state.fit, among=among)
    return replace(state, ranking=ranking, supported=ranking.ranked, **more)


def in_place_of(ranked, effect, fit):
    """A candidate beside which that effect is superfluous: its model lacks it."""
    return replace(ranked, fit=fit, instead_of=effect)


def test_what_an_added_effect_stood_in_for_takes_its_place(use):
    """But not where the search was with this set of effects before."""
    table = use(shares(spring=0.8, hardening_spring=0.4, bias=0.1))
    state = table.state(table.rungs("hardening_spring", "bias"))
    (ranked,) = table.rank(state.fit, among=[SPRING]).ranked
    ranked = in_place_of(ranked, HARD, table.fit("spring", "bias"))
    ranking = Ranking(state.fit, (ranked,))
    moved = add(table.search(), replace(state, ranking=ranking, supported=(ranked,)))
    assert sorted(names(moved)) == ["bias", "spring"]
    spring = next(r for r in moved.rungs[1:] if r.added == SPRING)
    assert spring.replaced is None, "the user's model never had what it takes the place of"
    assert moved.fit.check_error == pytest.approx(0.1)
    again = replace(state, ranking=ranking, supported=(ranked,), visited=frozenset({moved.effects}))
    assert add(table.search(), again) is None


def masked(names, both=0.1):
    """Each of a spring and a bias explains next to nothing without the other."""
    if {"spring", "bias"} <= names:
        return both
    return 0.97 if "spring" in names else 0.96 if "bias" in names else 1.0


def two_added(use, monkeypatch, rule, *, tone=None):
    """What `add_two` adds to a model without an effect."""
    table = use(rule)
    monkeypatch.setattr(Names, "holder", lambda model, at: at, raising=False)
    search = table.search()

    def rank(base, *, step, body):
        lacks = [c for c in (SPRING, BIAS) if not base.model.has(c.effect.name)]
        return table.rank(base, among=lacks, step=step)

    search.rank, search.plan = rank, PLAN
    state = looked(table, table.state(table.rungs()), SPRING, BIAS)
    residual = None if tone is None else tone * np.cos(np.arange(SHAPE.size)) / 14.0
    moved = add_two(search, replace(state, supported=(), tone=Tone(residual)))
    return None if moved is None else set(names(moved))


@pytest.mark.parametrize(("rule", "added"), [
    (masked, {"spring", "bias"}),
    # the spring does it alone
    (lambda names: 1.0 - 0.9 * ("spring" in names) - 1e-4 * ("bias" in names), None),
    # together they leave most of the force
    (lambda names: masked(names, 0.8), None),
    (lambda names: masked(names, 0.6), {"spring", "bias"}),
])  # fmt: skip
def test_two_that_mask_each_other_are_added_where_each_is_needed(use, monkeypatch, rule, added):
    assert two_added(use, monkeypatch, rule) == added

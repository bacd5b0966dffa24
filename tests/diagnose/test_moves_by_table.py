"""What is added and removed, where each set of effects leaves a stated error."""

from dataclasses import replace

import pytest
from diagnose.stub_models import Table, candidate

from teleopdesign.diagnose import rung as rungs_module
from teleopdesign.diagnose.moves import add
from teleopdesign.diagnose.ranking import Ranking

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

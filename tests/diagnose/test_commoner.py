"""Which effect is named of two that the records hardly tell apart, by a table of errors."""

from dataclasses import replace

import pytest
from diagnose.stub_models import Table, candidate

from teleopdesign.diagnose import moves as module
from teleopdesign.diagnose import rung as rungs_module
from teleopdesign.diagnose.moves import swap
from teleopdesign.diagnose.probability import list_rarer, shares
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.effects import EFFECTS

SPRING, GRAVITY = map(candidate, ("spring", "gravity"))


def rule(names, *, gravity=0.3001, spring=0.3):
    """A spring and gravity explain nearly the same; a bias a little besides."""
    left = gravity if "gravity" in names else spring if "spring" in names else 1.0
    return left - 0.05 * ("bias" in names)


@pytest.fixture
def use(monkeypatch):
    def with_rule(rule=rule, *, undetermined="over a travel of 1 rad it is hardly told", **more):
        table = Table(rule, **more)
        known = {n: EFFECTS[n] for n in ("spring", "gravity")}
        fit = table.estimate

        def estimate(model, prepared):
            return fit(replace(model, known=known), prepared)

        monkeypatch.setattr(
            Table, "estimate", lambda self, model, prepared: estimate(model, prepared)
        )
        monkeypatch.setattr(rungs_module, "estimate", estimate)
        alone = lambda base, c, fit, *, prepared, instead_of: table.rank(base, among=[c]).best  # noqa: E731
        monkeypatch.setattr(rungs_module, "make_ranked", alone)
        monkeypatch.setattr(
            module, "undetermined_of", lambda effect, at, model, prepared: undetermined
        )
        return table

    return with_rule


def names(state):
    return [r.added.effect.name for r in state.rungs[1:]]


@pytest.mark.parametrize("added", [("spring",), ("spring", "bias"), ("bias", "spring")])
def test_gravity_takes_the_place_of_a_spring_that_is_hardly_distinguished_from_it(use, added):
    table = use()
    moved = swap(table.search(), table.state(table.rungs(*added)))
    assert set(names(moved)) == {"gravity", *added} - {"spring"}
    assert swap(table.search(), moved) is None, "and stays"


@pytest.mark.parametrize("name", sorted(n for n, e in EFFECTS.items() if e.commoner))
def test_an_effect_that_has_a_commoner_one_says_where_the_two_are_hardly_distinguished(name):
    effect = EFFECTS[name]
    assert effect.commoner in EFFECTS and effect.undetermined is not None
    assert EFFECTS[effect.commoner].role == effect.role
    assert EFFECTS[effect.commoner].commoner != name, "one of the two is the commoner one"


def test_the_rarer_one_has_its_share_of_the_probability(use):
    table = use()
    rung = table.rungs("gravity")[1]
    both = table.rank(table.fit(), among=[SPRING, GRAVITY])
    assert list_rarer(GRAVITY, both) == [SPRING] and list_rarer(SPRING, both) == []
    share = shares(both, rung)
    assert share[GRAVITY.key] == pytest.approx(1 / 1.3) and sum(share.values()) == pytest.approx(1)
    far = Ranking(
        both.base, tuple(replace(r, behind=9.0 * (r.candidate == SPRING)) for r in both.ranked)
    )
    assert shares(far, rung)[GRAVITY.key] == pytest.approx(1), "what leaves surely more has none"

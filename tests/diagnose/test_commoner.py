"""Which effect is named of two that the records hardly tell apart, by a table of errors."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from diagnose.stand_ins import floor
from diagnose.stub_models import Table, candidate

from teleopdesign.diagnose import moves as module
from teleopdesign.diagnose import rungs as rungs_module
from teleopdesign.diagnose.moves import swap
from teleopdesign.diagnose.probability import list_rarer, shares
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.diagnose.result import _indistinguishable
from teleopdesign.diagnose.statements import SetAside, Undetermined
from teleopdesign.effects import EFFECTS

SPRING, GRAVITY, BIAS = map(candidate, ("spring", "gravity", "bias"))


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


def test_a_spring_stays_where_only_noise_is_left(use):
    table = use()
    state = table.state(table.rungs("spring"))
    noise = floor(0.25)
    assert swap(table.search(), replace(state, floor=noise)) is None


def test_a_spring_takes_the_place_of_gravity_where_only_noise_is_left_in_the_end(use):
    """Gravity stood for it while another effect was missing, too."""
    table = use()
    state = table.state(table.rungs("gravity", "bias"))
    noise = floor(0.25)
    there = replace(state, floor=noise)
    assert names(swap(table.search(), there)) == ["spring", "bias"]
    been = frozenset({frozenset({("spring", "device"), ("bias", "device")})})
    assert swap(table.search(), replace(there, visited=been)) is None


def test_gravity_stays_where_only_noise_is_left_and_the_records_tell_it_from_a_spring(use):
    table = use(lambda names: rule(names, spring=0.4, gravity=0.3))
    noise = floor(0.25)
    there = replace(table.state(table.rungs("gravity", "bias")), floor=noise)
    assert swap(table.search(), there) is None


def test_a_spring_stays_where_the_records_tell_it_from_gravity(use):
    surely = use(lambda names: rule(names, gravity=0.6))
    assert swap(surely.search(), surely.state(surely.rungs("spring"))) is None
    by_travel = use(undetermined=None)
    assert swap(by_travel.search(), by_travel.state(by_travel.rungs("spring"))) is None


@pytest.mark.parametrize("message", ["is_identifiable", "refused", "implausible", "instead_of"])
def test_a_spring_stays_where_gravity_is_no_candidate(use, message):
    values = {"is_identifiable": False, "refused": "blind", "implausible": "it stands for a spring"}
    table = use(ranked={"gravity": {message: values.get(message, BIAS)}})
    assert swap(table.search(), table.state(table.rungs("spring"))) is None


def test_gravity_that_was_set_aside_does_not_come_back_for_a_spring(use):
    table = use()
    state = table.state(table.rungs("spring"))
    gone = SetAside(GRAVITY, 0.3, "the fit records leave its values open")
    assert swap(table.search(), replace(state, set_aside=(gone,))) is None
    been = replace(state, visited=frozenset({frozenset({("gravity", "device")})}))
    assert swap(table.search(), been) is None, "a ladder does not go round"


def test_a_spring_stays_in_a_model_that_has_gravity_beside_it(use):
    table = use()
    assert swap(table.search(), table.state(table.rungs("gravity", "spring"))) is None


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


def look_alikes(undetermined, *there, arm=False):
    """The pairs of a diagnosis that accepted these effects, of which some are `undetermined`."""
    body = SimpleNamespace(has=there.__contains__, axis="revolute")
    model = SimpleNamespace(known=EFFECTS, body=lambda at: body)
    prepared = SimpleNamespace(is_linked=arm)
    entries = tuple(Undetermined(candidate(n), "over a travel of 1 rad") for n in undetermined)
    after, search = SimpleNamespace(model=model), SimpleNamespace(whole=prepared)
    return _indistinguishable(
        SimpleNamespace(rungs=(), after=after, undetermined=entries, search=search)
    )


def test_a_spring_and_gravity_stand_beside_each_other_in_the_answer_whichever_is_named():
    assert look_alikes(["spring"], "spring") == ((SPRING, GRAVITY),)
    assert look_alikes(["gravity", "gravity"], "gravity") == ((GRAVITY, SPRING),)
    assert look_alikes(["stribeck"], "stribeck") == () == look_alikes([], "spring")
    assert look_alikes(["spring"], "spring", "gravity") == (), "the model has both"
    assert look_alikes(["spring"], "spring", arm=True) == (), "the links of an arm have gravity"

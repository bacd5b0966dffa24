"""Two or more effects added at once, where each set of effects leaves a stated error."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.stand_ins import SHAPE, fit, floor
from diagnose.stub_models import Names, Table, candidate

from teleopdesign.diagnose import ladder_state
from teleopdesign.diagnose import pairs as pairs_module
from teleopdesign.diagnose import rungs as rungs_module
from teleopdesign.diagnose import together as together_module
from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.outside_tone import Tone
from teleopdesign.diagnose.pairs import add_pair, replace_by_pair
from teleopdesign.diagnose.search_plan import PLAN
from teleopdesign.diagnose.together import _leave_the_same, add_together

SPRING, BIAS, DRAG = map(candidate, ("spring", "bias", "quadratic_drag"))
#: it leaves as much as a bias
TWIN = candidate("coulomb_asymmetry")


@pytest.fixture
def use(monkeypatch):
    """A table by which everything is estimated, and what the best tone leaves."""
    monkeypatch.setattr(Names, "holder", lambda model, at: at, raising=False)

    def with_rule(rule, *, tone=None, implausible=(), alone=(), free=()):
        """alone: what another effect takes away, by name;  free: free parameters, by effect"""
        gains, sizes = {"quadratic_drag": 0.05, **dict(alone)}, dict(free)
        table = Table(
            lambda names: (
                rule("spring" in names, not names.isdisjoint({"bias", "coulomb_asymmetry"}))
                - sum(gain for name, gain in gains.items() if name in names)
            )
        )
        estimate_by_table = table.estimate

        def estimated(model, prepared):
            one = estimate_by_table(model, prepared)
            one.free = tuple(f"{n}{k}" for n in model.names for k in range(sizes.get(n, 1)))
            return one

        object.__setattr__(table, "estimate", estimated)
        left = Tone() if tone is None else Tone(tone * np.cos(np.arange(SHAPE.size)) / 14.0)
        estimate = lambda model, prepared, **_: table.estimate(model, prepared)  # noqa: E731
        for module in (rungs_module, together_module):
            monkeypatch.setattr(module, "estimate", estimate)
        for module in (pairs_module, together_module):
            monkeypatch.setattr(module, "best_tone", lambda *_: left)
        monkeypatch.setattr(together_module, "implausible_effects", lambda *_: implausible)
        monkeypatch.setattr(together_module, "_sureness", lambda fit, one: one.effect.name)
        ranked = lambda base, c, fit, *, prepared, instead_of: table.rank(base, among=[c]).best  # noqa: E731
        monkeypatch.setattr(rungs_module, "make_ranked", ranked)
        return table

    return with_rule


def searched(table):
    """A search that ranks the candidates which a model lacks."""

    def rank(base, *, step, among=None, body=None):
        there = (SPRING, BIAS) if among is None else among
        lacks = [c for c in there if not base.model.has(c.effect.name)]
        return table.rank(base, among=lacks, step=step)

    search = table.search()
    search.rank, search.plan, search.progress = rank, PLAN, lambda line: None
    return search


def added(state):
    return None if state is None else {r.added.effect.name for r in state.rungs[1:]}


def leaves(both, *, spring=0.97, bias=0.96):
    """The error beside a spring, a bias and both; 1 without. As much would be the same effect."""
    return lambda has_spring, has_bias: (
        both if has_spring and has_bias else spring if has_spring else bias if has_bias else 1.0
    )


#: each masks the other
masked = leaves(0.1)


def pair(table):
    """What `add_pair` adds to a model without an effect."""
    search, state = searched(table), table.state(table.rungs())
    return add_pair(search, replace(state, ranking=search.rank(state.fit, step=1)))


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        (masked, {"spring", "bias"}),
        # the spring does it alone
        (leaves(0.0999, spring=0.1), None),
        # together they leave most of the force
        (leaves(0.8), None),
        (leaves(0.6), {"spring", "bias"}),
    ],
)
def test_a_pair_explains_most_and_each_of_it_is_needed(use, rule, expected):
    assert added(pair(use(rule))) == expected


@pytest.mark.parametrize(("tone", "expected"), [(0.05, None), (0.5, {"spring", "bias"})])
def test_a_pair_leaves_less_than_the_best_tone(use, tone, expected):
    assert added(pair(use(masked, tone=tone))) == expected


def in_place(table, *, lone="quadratic_drag", least=0.01, partial=True, **more):
    """What `replace_by_pair` makes of one effect; least: the noise floor."""
    search = searched(table)
    search.plan = replace(PLAN, partial_pairs=partial)
    state = table.state(table.rungs(lone), **more)
    state = replace(state, floors=replace(state.floors, allowed=floor(least)))
    first = search.rank(state.rungs[0].fit, step=1)
    rungs = (state.rungs[0], replace(state.rungs[1], ranking=first))
    return replace_by_pair(search, replace(state, rungs=rungs))


def test_a_pair_takes_the_place_of_one_effect_once(use):
    moved = in_place(use(masked))
    assert added(moved) == {"spring", "bias"} and moved.replaced
    assert in_place(use(masked), replaced=True) is None


@pytest.mark.parametrize(
    ("both", "expected"), [(0.15, {"spring", "bias"}), (0.25, None), (0.31, None)]
)
def test_a_pair_in_place_of_an_effect_leaves_less_than_half_of_its_squares(use, both, expected):
    """The effect alone leaves 0.3."""
    table = use(leaves(both), alone={"gravity": 0.7})
    assert added(in_place(table, lone="gravity")) == expected
    # where a pair must leave noise alone, 0.15 are noise beside a floor of 0.1
    assert in_place(table, lone="gravity", partial=False) is None
    noise = in_place(table, lone="gravity", partial=False, least=0.1)
    assert added(noise) == ({"spring", "bias"} if both < 0.18 else None)


@pytest.mark.parametrize(
    ("lone", "both", "size", "expected"),
    [
        ("maxwell_slip", 0.12, 2, {"spring", "bias"}),
        ("maxwell_slip", 0.12, 3, {"spring", "bias"}),
        ("maxwell_slip", 0.12, 4, None),  # more free parameters
        ("maxwell_slip", 0.16, 2, None),  # no better
        ("gravity", 0.12, 2, None),  # too few parameters to imitate two effects
    ],
)
def test_where_noise_is_left_a_pair_replaces_what_may_imitate_two_effects(
    use, lone, both, size, expected
):
    """The effect alone leaves 0.15, beside a floor of 0.1, with three free parameters."""
    free = {lone: 3, "spring": size - 1}
    table = use(leaves(both), alone={lone: 0.85}, free=free)
    assert added(in_place(table, lone=lone, least=0.1)) == expected


def together(table, among=(SPRING, BIAS), **more):
    """What `add_together` makes of a state with drag alone, which was ranked beside these."""
    search = searched(table)
    state = table.state(table.rungs("quadratic_drag"), **more)
    first = search.rank(state.rungs[0].fit, step=1, among=among)
    rungs = (state.rungs[0], replace(state.rungs[1], ranking=first))
    return add_together(search, replace(state, rungs=rungs))


def test_effects_are_chosen_beside_the_users_model_not_beside_the_last(use):
    """Beside the drag nothing was ranked."""
    moved = together(use(masked))
    assert added(moved) == {"spring", "bias"} and moved.together and moved.replaced
    table = use(masked)
    search, state = searched(table), table.state(table.rungs())
    begun = replace(state, ranking=search.rank(state.fit, step=1))
    assert added(add_together(search, begun)) == {"spring", "bias"}


@pytest.mark.parametrize(
    "rule",
    [
        # one of the two is superfluous, though the other is much better than the drag
        leaves(0.0999, spring=0.1),
        leaves(0.0999, bias=0.1),
        # both are needed, and leave as much as the drag
        leaves(0.95, spring=0.99, bias=0.985),
        # both are needed, and leave most of the force
        leaves(0.75),
    ],
)
def test_at_least_two_are_needed_and_explain_most_of_what_the_rungs_leave(use, rule):
    assert together(use(rule)) is None
    assert added(together(use(leaves(0.6)))) == {"spring", "bias"}


def test_what_leaves_exactly_as_much_as_one_of_them_is_an_alternative_to_it(use):
    """Only one of the two is added, whichever is ranked first."""
    moved = together(use(masked), among=(SPRING, BIAS, TWIN))
    alternatives = {r.added: set(r.alternatives) for r in moved.rungs[1:]}
    assert alternatives in ({SPRING: set(), BIAS: {TWIN}}, {SPRING: set(), TWIN: {BIAS}})


def test_none_is_implausible_or_leaves_more_than_a_tone(use):
    assert together(use(masked, implausible=[SPRING.key])) is None
    assert added(together(use(masked, implausible=[DRAG.key]))) == {"spring", "bias"}
    assert together(use(masked, tone=0.05)) is None
    assert added(together(use(masked, tone=0.5))) == {"spring", "bias"}


@pytest.mark.parametrize("way", [-1.0, 1.0])
@pytest.mark.parametrize(("apart", "same"), [(0.4e-6, True), (0.6e-6, False)])
def test_what_leaves_as_much_within_a_millionth_of_the_squares_is_the_same(apart, same, way):
    assert _leave_the_same(fit(0.3), fit(0.3 * (1.0 + way * apart))) == same


def test_the_floor_of_the_users_model_is_limited_again_only_while_it_is_the_last(monkeypatch):
    monkeypatch.setattr(ladder_state, "limit_noise_floor", lambda *_: floor(0.05))
    table = Table(lambda names: 1.0)
    for names, expected in (((), 0.05), (("spring",), 0.03)):
        state = replace(table.state(table.rungs(*names)), first=floor(0.03))
        assert state.with_floor_limited(CRITERIA).first.value == expected

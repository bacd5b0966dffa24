"""Which effect gives way to which, where each set of effects leaves a stated error."""

from dataclasses import replace

import pytest
from diagnose.stand_ins import floor
from diagnose.stub_models import Table, candidate

from teleopdesign.diagnose import rungs as module
from teleopdesign.diagnose.exchange import (
    best_exchange,
    compare_alternatives,
    exchange,
    rivals_of,
)
from teleopdesign.diagnose.rung import Replaced
from teleopdesign.diagnose.statements import SetAside

SPRING, HARD, BIAS, DRAG = map(candidate, ("spring", "hardening_spring", "bias", "quadratic_drag"))
EVERY = (SPRING, HARD, BIAS, DRAG)


def error(names):
    """A spring and a bias are missing; a hardening spring is half a spring, with a drag more.

    Alone it explains most, for it takes a part of the bias as well.
    """
    squares = 0.02 + 0.3 * ("bias" not in names)
    if "spring" not in names:
        squares += 0.6
        if "hardening_spring" in names:
            squares -= 0.45 if "bias" in names else 0.65
            squares -= 0.05 * ("quadratic_drag" in names)
    return squares**0.5


@pytest.fixture
def use(monkeypatch):
    """A table by which everything is estimated."""

    def with_table(rule=error, **more):
        table = Table(rule, **more)
        monkeypatch.setattr(module, "estimate", table.estimate)
        alone = lambda base, c, fit, *, prepared, instead_of: table.rank(base, among=[c]).best  # noqa: E731
        monkeypatch.setattr(module, "make_ranked", alone)
        return table

    return with_table


def effects(state):
    return [r.added.effect.name for r in state.rungs[1:]]


def ladder(table, *names, **more):
    """The state with these effects, each ranked beside all others when it was added."""
    rungs = table.rungs(*names)
    ranked = [
        replace(r, ranking=table.rank(before.fit, among=EVERY))
        for before, r in zip(rungs, rungs[1:], strict=False)
    ]
    return table.state([rungs[0], *ranked], **more)


def test_a_stand_in_that_came_first_gives_way_and_what_it_needed_goes(use):
    table = use()
    state = ladder(table, "hardening_spring", "bias", "quadratic_drag")
    moved = exchange(table.search(), state)
    assert sorted(effects(moved)) == ["bias", "spring"] and moved.exchanges == 1
    spring = next(r for r in moved.rungs[1:] if r.added == SPRING)
    assert spring.fit.model.names >= {"spring"} and not spring.alternatives
    errors = [r.fit.check_error for r in moved.rungs]
    assert errors == sorted(errors, reverse=True) and moved.fit.check_error == error(
        {"spring", "bias"}
    )
    assert exchange(table.search(), moved) is None, "nothing is better than the truth"


def test_nothing_is_exchanged_where_noise_is_left_or_too_often(use):
    table = use()
    state = ladder(table, "hardening_spring", "bias", "quadratic_drag")
    assert exchange(table.search(), replace(state, exchanges=1)).exchanges == 2
    assert exchange(table.search(), replace(state, exchanges=2)) is None
    noise = floor(state.fit.check_error / 1.7)
    quiet = replace(state, floors=replace(state.floors, allowed=noise))
    assert exchange(table.search(), quiet) is None


def test_what_was_set_aside_or_is_there_already_is_no_rival(use):
    table = use()
    state = ladder(table, "hardening_spring", "bias", "quadratic_drag")
    aside = (SetAside(SPRING, 0.1, "it is not told from absence"),)
    assert exchange(table.search(), replace(state, set_aside=aside)) is None
    ranking = state.rungs[1].ranking
    low = floor(0.01)
    assert set(rivals_of(ranking, [], low)) == {SPRING, HARD, BIAS}
    assert set(rivals_of(ranking, [HARD, BIAS], low)) == {SPRING}
    assert rivals_of(ranking, [HARD, BIAS, SPRING], low) == []


def test_the_last_is_exchanged_only_where_an_earlier_one_changed_after_it(use):
    """It was ranked beside all the others a moment ago."""

    def rule(names):
        return (
            1.0
            - 0.3 * ("bias" in names)
            - 0.4 * ("spring" in names)
            - 0.3 * ("hardening_spring" in names and "spring" not in names)
        )

    table = use(rule)
    state = ladder(table, "bias", "hardening_spring")
    assert exchange(table.search(), state) is None
    changed = replace(state.rungs[1], fit=table.fit("bias"))
    state = state.with_rungs((state.rungs[0], changed, state.rungs[2]))
    assert sorted(effects(exchange(table.search(), state))) == ["bias", "spring"]


def test_the_exchange_that_leaves_least_is_made(use):
    """Of two effects to replace, and of two in the place of each."""

    def rule(names):
        worth = {"bias": 0.1, "spring": 0.3, "viscous": 0.15, "cogging": 0.25, "gravity": 0.2}
        return 1.0 - sum(worth[n] for n in names)

    table = use(rule)
    present = table.fit("bias", "viscous")
    spring, cogging, gravity, bias, viscous = map(
        candidate, ("spring", "cogging", "gravity", "bias", "viscous")
    )
    low = floor(0.01)
    for rivals, dropped, replacement in [
        ({bias: [cogging, spring], viscous: [gravity]}, bias, spring),
        ({bias: [spring, cogging], viscous: [gravity]}, bias, spring),
        ({bias: [cogging], viscous: [cogging]}, bias, cogging),
        ({viscous: [gravity], bias: []}, viscous, gravity),
    ]:
        best = best_exchange(table.search(), present, rivals, low)
        assert (best.dropped, best.replacement.candidate) == (dropped, replacement)
        assert best.without.model.names == {"bias", "viscous"} - {dropped.effect.name}
        assert best.ranking.base is best.without
    assert best_exchange(table.search(), table.fit("spring"), {spring: [cogging]}, low) is None


def test_one_that_is_simpler_takes_the_place_where_it_leaves_no_more(use):
    def rule(names):
        return 1.0 - 0.5 * bool(names & {"cogging", "gravity"})

    table = use(rule)
    cogging, gravity, low = candidate("cogging"), candidate("gravity"), floor(0.01)
    best = best_exchange(table.search(), table.fit("cogging"), {cogging: [gravity]}, low)
    assert best.replacement.candidate == gravity
    assert best_exchange(table.search(), table.fit("gravity"), {gravity: [cogging]}, low) is None


@pytest.mark.parametrize(
    "why", [{"is_identifiable": False}, {"implausible": "a bristle"}, {"instead_of": BIAS}]
)
def test_what_does_not_count_or_would_replace_another_as_well_takes_no_place(use, why):
    table = use(ranked={"spring": why})
    present = table.fit("hardening_spring", "bias")
    rivals, low = {HARD: [SPRING]}, floor(0.01)
    assert best_exchange(table.search(), present, rivals, low) is None
    assert best_exchange(use().search(), present, rivals, low) is not None


def test_what_another_effect_needs_is_not_exchanged(use):
    table = use(needs=(("bias", "hardening_spring"),))
    present = table.fit("hardening_spring", "bias")
    assert best_exchange(table.search(), present, {HARD: [SPRING]}, floor(0.01)) is None


def test_what_an_effect_replaced_is_back_where_the_effect_goes(use):
    table = use()
    gone = Replaced(DRAG, ())
    present, rivals = table.fit("hardening_spring", "bias"), {HARD: [SPRING]}
    replaced = {HARD: gone}
    best = best_exchange(table.search(), present, rivals, floor(0.01), replaced=replaced)
    assert best.without.model.names == {"bias", "quadratic_drag"}
    best = best_exchange(table.search(), present, rivals, floor(0.01), replaced={HARD: None})
    assert best.without.model.names == {"bias"}


def with_alternatives(table, first, *others, then="bias"):
    """A ladder whose first effect stands for others too, and that one followed."""
    state = ladder(table, first, then)
    rung = replace(state.rungs[1], alternatives=tuple(map(candidate, others)))
    return state.with_rungs((state.rungs[0], rung, *state.rungs[2:]))


def of_three(names):
    """Beside a bias a spring and gravity explain the same, and viscous friction less."""
    best = max(
        ({"spring": 0.3, "gravity": 0.2999, "viscous": 0.2}.get(n, 0) for n in names), default=0
    )
    return 1.0 - best - 0.3 * ("bias" in names)


def test_of_alternatives_those_that_stay_equal_stay_and_the_accepted_one_first(use):
    table = use(of_three)
    for first, others, stays, left in [
        ("gravity", ("spring", "viscous"), "gravity", ("spring",)),
        ("viscous", ("gravity", "spring"), "spring", ("gravity",)),
        ("viscous", ("gravity",), "gravity", ()),
        ("spring", ("viscous",), "spring", ()),
    ]:
        moved = compare_alternatives(table.search(), with_alternatives(table, first, *others))
        rung = next(r for r in moved.rungs[1:] if r.added != BIAS)
        assert rung.added == candidate(stays)
        assert [c.effect.name for c in rung.alternatives] == list(left)
        assert moved.fit.model.names == {stays, "bias"}


def test_alternatives_that_are_as_equal_as_before_stay(use):
    table = use(of_three)
    state = with_alternatives(table, "gravity", "spring")
    assert compare_alternatives(table.search(), state) is None
    # none is supported beside what followed
    useless = use(lambda names: 1.0 - 0.3 * ("bias" in names))
    state = with_alternatives(useless, "gravity", "spring")
    assert compare_alternatives(useless.search(), state) is None


def test_alternatives_of_what_replaced_another_or_is_needed_stay(use):
    table = use(of_three)
    state = with_alternatives(table, "viscous", "spring")
    first = replace(state.rungs[1], replaced=Replaced(DRAG, ()))
    kept = state.with_rungs((state.rungs[0], first, state.rungs[2]))
    assert compare_alternatives(table.search(), kept) is None
    needed = use(of_three, needs=(("bias", "viscous"),))
    state = with_alternatives(needed, "viscous", "spring")
    assert compare_alternatives(needed.search(), state) is None


def test_an_alternative_that_would_replace_another_effect_as_well_is_none(use):
    table = use(of_three, ranked={"spring": {"instead_of": BIAS}})
    moved = compare_alternatives(
        table.search(), with_alternatives(table, "viscous", "gravity", "spring")
    )
    rung = next(r for r in moved.rungs[1:] if r.added != BIAS)
    assert (rung.added, rung.alternatives) == (candidate("gravity"), ())

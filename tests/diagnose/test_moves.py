"""Each move of the ladder alone: what it leads to, and when it is none."""

from dataclasses import replace

import pytest
from diagnose.shared_fits import each_ranking_once, fit_beside
from diagnose.simulated_cases import write_simulated

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose import climb as climbing
from teleopdesign.diagnose import moves as moving
from teleopdesign.diagnose.adequacy import is_adequate
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.conclusion import remove_doubtful_rung
from teleopdesign.diagnose.ladder_state import LadderSearch, begin, look, search_for
from teleopdesign.diagnose.moves import add, add_two, remove, swap
from teleopdesign.diagnose.rank import make_ranked
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.diagnose.rung import Rung
from teleopdesign.diagnose.statements import SetAside
from teleopdesign.effects import EFFECTS

pytestmark = pytest.mark.slow  # diagnoses of whole cases

KNOWN = ("spring", "hardening_spring", "bias", "quadratic_drag", "viscous", "coulomb")


@pytest.fixture(scope="module", autouse=True)
def shared():
    with each_ranking_once():
        yield


@pytest.fixture(scope="module")
def ladder(tmp_path_factory):
    """The search on a machine whose model lacks a spring and a bias, and its first state."""
    folder = write_simulated(tmp_path_factory.mktemp("moves") / "case", "bias+spring")
    experiment = load_experiment(folder)
    known = {name: EFFECTS[name] for name in KNOWN}
    search = search_for(experiment, Model.from_experiment(experiment, known))
    return search, begin(search)


def added(state):
    return [rung.added.key[0] for rung in state.rungs[1:]]


def with_effects(search, state, *names):
    """The state with these effects added one after the other, whatever the records say of them."""
    for name in names:
        candidate = Candidate(EFFECTS[name], "device")
        fit = fit_beside(search.prepared, state.fit, candidate)
        ranking = Ranking(
            state.fit, (make_ranked(state.fit, candidate, fit, prepared=search.prepared),)
        )
        state = state.with_rungs((*state.rungs, Rung(candidate, fit, ranking)))
    return state


def with_stand_in(search, state):
    """The state where a hardening spring, ranked beside all others, was added alone."""
    moved = with_effects(search, state, "hardening_spring")
    first = replace(moved.rungs[1], ranking=state.ranking)
    return moved.with_rungs((moved.rungs[0], first))


def test_what_is_added_is_the_first_that_the_records_support(ladder):
    search, state = ladder
    moved = add(search, state)
    assert added(moved) == [state.supported[0].candidate.key[0]]
    assert moved.fit.check_error < state.fit.check_error
    assert moved.rungs[-1].ranking is state.ranking and state.step == 1


def test_nothing_is_added_where_nothing_is_supported(ladder):
    search, state = ladder
    assert add(search, replace(state, supported=())) is None


def test_what_explains_nothing_is_no_candidate_any_more(ladder, monkeypatch):
    search, state = ladder
    moved = add(search, state)
    assert climbing.bar_what_explains_nothing(search, state, moved) is None, "it is missing"
    best = state.supported[0].candidate
    aside = SetAside(best, moved.fit.check_error, "other values do as much")
    monkeypatch.setattr(climbing, "stands_in_for_values", lambda *_, **__: aside)
    barred = climbing.bar_what_explains_nothing(search, state, moved)
    assert barred.set_aside == (aside,) and barred.rungs == state.rungs
    left = [r.candidate for r in state.supported if r.candidate != best]
    assert [r.candidate for r in barred.supported] == left
    again = look(search, state.rungs, barred)
    assert best not in {r.candidate for r in again.supported}
    # what takes the place of rungs may do as much as they did, more simply
    stand_in = with_stand_in(search, state)
    pair = with_effects(search, state, "spring", "bias")
    assert pair.fit.check_error < stand_in.fit.check_error
    assert climbing.bar_what_explains_nothing(search, stand_in, pair) is None
    # a move that leaves no less is not asked
    same = moved.with_rungs((*moved.rungs[:-1], replace(moved.rungs[-1], fit=state.fit)))
    assert climbing.bar_what_explains_nothing(search, state, same) is None


def test_a_ladder_without_a_move_that_explains_something_ends(ladder, monkeypatch):
    search, state = ladder

    def none(base, rung, *_, **__):
        return SetAside(rung.added, rung.fit.check_error, "other values do as much")

    monkeypatch.setattr(climbing, "stands_in_for_values", none)
    as_they_are = replace(search, plan=replace(search.plan, corrected=False))
    last, rungs = climbing.climb(as_they_are, state)
    assert rungs == state.rungs and len(last.set_aside) >= 1


def test_what_is_added_to_a_model_that_leaves_noise_says_what_else_it_could_be(ladder):
    search, state = ladder
    assert add(search, state).rungs[-1].could_be is None
    noise = replace(state.floor, value=state.fit.check_error)
    quiet = replace(state, floor=noise)
    assert is_adequate(quiet.fit, quiet.floor)
    rung = add(search, quiet).rungs[-1]
    gain = state.fit.check_error**2 - rung.fit.check_error**2
    helps = {
        r.candidate
        for r in state.ranking.ranked
        if r.counts and state.fit.check_error**2 - r.fit.check_error**2 > 0.5 * gain
    }
    assert rung.could_be is not None
    assert set(rung.could_be) == helps - {rung.added}


def test_what_others_made_superfluous_is_removed(ladder):
    search, state = ladder
    full = with_effects(search, state, "quadratic_drag", "spring", "bias")
    moved = remove(search, full)
    assert added(moved) == ["spring", "bias"]
    assert remove(search, moved) is None


def test_alternatives_are_distinguished_by_what_followed_them(ladder):
    search, state = ladder
    drag, bias = (Candidate(EFFECTS[n], "device") for n in ("quadratic_drag", "bias"))
    model = with_effects(search, state, "quadratic_drag", "spring")
    undecided = replace(model.rungs[1], alternatives=(bias,))
    moved = swap(search, model.with_rungs((model.rungs[0], undecided, model.rungs[2])))
    assert set(added(moved)) == {"bias", "spring"}
    assert not any(rung.alternatives for rung in moved.rungs)
    assert moved.fit.check_error < model.fit.check_error
    assert swap(search, moved) is None
    # the right one stays, and loses its alternative
    right = with_effects(search, state, "bias", "spring")
    undecided = replace(right.rungs[1], alternatives=(drag,))
    right = right.with_rungs((right.rungs[0], undecided, right.rungs[2]))
    moved = swap(search, right)
    assert added(moved) == ["bias", "spring"] and not moved.rungs[1].alternatives
    # the last was ranked beside all others: nothing followed it
    last = right.with_rungs((*model.rungs[:1], undecided))
    assert swap(search, last) is None
    assert swap(search, state) is None


def with_open_bias(rungs):
    """Rungs whose last, a bias, explains a little, and is known to twice its size."""
    *before, previous, last = rungs
    value = last.fit.model.parameters["device.bias.force"]
    wide = last.fit.model.with_values(
        {"device.bias.force": replace(value, stderr=2.0 * abs(value.value))}
    )
    more = {n: 1.2 * getattr(last.fit, n) for n in ("fit_residual", "check_residual")}
    little = replace(previous, fit=replace(previous.fit, **more))
    return (*before, little, replace(last, fit=replace(last.fit, model=wide)))


def test_what_the_stated_errors_do_not_tell_from_absence_is_set_aside_once(ladder):
    search, state = ladder
    full = with_effects(search, state, "spring", "bias")
    stated = with_open_bias(full.rungs)
    moved = remove_doubtful_rung(search, full, stated)
    assert added(moved) == ["spring"]
    assert [one.candidate.key[0] for one in moved.set_aside] == ["bias"]
    assert "force = " in moved.set_aside[0].reason
    again = look(search, moved.rungs, moved)
    assert "bias" not in {r.candidate.key[0] for r in again.supported}
    back = replace(full, set_aside=moved.set_aside)
    assert remove_doubtful_rung(search, back, stated) is None


def test_where_the_only_effect_is_set_aside_the_model_alone_stands(ladder):
    search, state = ladder
    full = with_effects(search, state, "bias")
    stated = with_open_bias(full.rungs)
    moved = remove_doubtful_rung(search, full, stated)
    assert moved.rungs == (state.rungs[0],)
    assert [one.candidate.key[0] for one in moved.set_aside] == ["bias"]


def test_two_effects_that_make_each_other_superfluous_do_not_take_turns(ladder, monkeypatch):
    """One is added, and makes the other superfluous: only where that set was not there yet."""
    search, state = ladder
    one = with_effects(search, state, "spring")
    both = with_effects(search, one, "bias")
    monkeypatch.setattr(moving, "_add_candidate", lambda *_: both)
    monkeypatch.setattr(moving, "remove", lambda *_: one)
    supported = replace(state, supported=state.supported[:1], visited=frozenset())
    assert add(search, supported) is one
    again = replace(supported, visited=frozenset({one.effects}))
    assert add(search, again) is both
    assert add(search, replace(again, visited=frozenset({one.effects, both.effects}))) is None


def test_a_pair_is_added_to_the_model_alone(ladder):
    search, state = ladder
    moved = add_two(search, state)
    assert set(added(moved)) == {"spring", "bias"}
    errors = [rung.fit.check_error for rung in moved.rungs]
    assert errors == sorted(errors, reverse=True)
    assert is_adequate(moved.fit, moved.floor)
    assert add_two(search, moved) is None


def test_the_second_of_a_pair_is_sought_at_the_body_of_the_first(ladder, monkeypatch):
    search, state = ladder
    questions = []

    def rank(self, base, *, body=None, **_):
        questions.append(body)
        return Ranking(base, ())

    monkeypatch.setattr(LadderSearch, "rank", rank)
    assert add_two(search, state) is None
    assert questions and set(questions) == {"device"}

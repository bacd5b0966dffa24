"""A new effect is not given what other values of the model explain: their distant minimum is."""

import pytest

from teleopdesign import EFFECTS, Model, example, load_experiment
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.ladder_state import LadderState, search_for
from teleopdesign.diagnose.led_astray import return_from_astray
from teleopdesign.diagnose.rung import Rung

SPEED = "device.stribeck.stribeck_velocity"
RIPPLE = {"amplitude": 1e-6, "period": 0.01, "phase": 0.0}


@pytest.fixture(scope="module")
def rod():
    """A search on the rod whose user states the Stribeck effect, and the fit of this model."""
    experiment = load_experiment(example("rod"))
    stated = Model.from_experiment(experiment).with_effect(
        "stribeck", values={"extra_static_level": 0.2, "stribeck_velocity": 0.02}
    )
    search = search_for(experiment, stated)
    return search, estimate(stated, search.prepared)


def state_of(*rungs):
    nothing = dict.fromkeys(("floors", "first", "ranking", "tone", "supported"))
    return LadderState(rungs, **nothing)


def with_cogging(fit, prepared):
    """The rung of a cogging of next to nothing beside a fit."""
    model = fit.model.with_effect("cogging", values=RIPPLE)
    return Rung(Candidate(EFFECTS["cogging"], "device"), estimate(model, prepared))


def test_an_effect_is_not_given_what_the_values_of_another_effect_explain(rod):
    search, right = rod
    astray = estimate(right.model.with_values({SPEED: 1e8}), search.prepared)
    assert astray.check_error > 3.0 * right.check_error  # no search returns from there
    state = state_of(Rung(None, astray))
    moved = state.with_rungs((*state.rungs, with_cogging(right, search.prepared)))
    back = return_from_astray(search, state, moved)
    assert back.effects == state.effects and len(back.rungs) == 1
    assert back.fit.check_error == pytest.approx(right.check_error, rel=0.01)
    assert back.fit.model.parameters[SPEED].value == pytest.approx(
        right.model.parameters[SPEED].value, rel=0.05
    )


def test_an_effect_that_explains_its_gain_itself_stays(rod):
    search, right = rod
    stribeck = Rung(Candidate(EFFECTS["stribeck"], "device"), right)
    state = state_of(Rung(None, estimate(stribeck.undo_addition(right.model), search.prepared)))
    moved = state.with_rungs((*state.rungs, stribeck))
    assert return_from_astray(search, state, moved) is None


def test_a_move_that_replaces_rungs_is_left_alone(rod):
    search, right = rod
    state = state_of(Rung(None, right))
    moved = state.with_rungs((Rung(None, right), with_cogging(right, search.prepared)))
    assert return_from_astray(search, state, moved) is None

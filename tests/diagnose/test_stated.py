"""A search also starts from the user's values, unless it reaches them anyway."""

from dataclasses import replace

import pytest

import teleopdesign as td
from teleopdesign.diagnose import further_starts, search
from teleopdesign.diagnose.effort import EFFORTS
from teleopdesign.diagnose.fit import estimate, free_parameters
from teleopdesign.diagnose.search_plan import PLAN
from teleopdesign.diagnose.stated import is_at_stated
from teleopdesign.measurement.prepare import prepare

STRIBECK = {"extra_static_level": 0.2, "stribeck_velocity": 0.022}


@pytest.fixture(scope="module")
def fitted():
    """The rod's records with few samples, and a rough fit of a model that has all that it needs."""
    experiment = td.load_experiment(td.example("rod"))
    model = td.Model.from_experiment(experiment).with_effect("stribeck", values=STRIBECK)
    model = model.with_effect("bias", values={"force": 0.01})
    prepared = prepare(experiment).coarse
    return prepared, estimate(model, prepared, effort=EFFORTS.rough)


def stated_with(fit, factor):
    level = fit.model.parameters["device.coulomb.level"].value
    return fit.model.with_values({"device.coulomb.level": factor * level})


@pytest.mark.parametrize("away, is_near", [(0.0, True), (0.9, True), (1.1, False)])
def test_a_value_counts_as_the_users_within_what_users_err_by(fitted, away, is_near):
    _, fit = fitted
    stated = stated_with(fit, 1.0 / (1.0 + away * PLAN.moved))
    assert is_at_stated(fit, stated, "device") is is_near


def test_what_ends_at_the_users_values_is_not_sought_from_them(fitted, monkeypatch):
    prepared, fit = fitted
    solved = []
    solve = further_starts.solve
    monkeypatch.setattr(further_starts, "solve", lambda *a: solved.append(a) or solve(*a))
    assert search.from_stated(fit, prepared, stated_with(fit, 1.1), "device") is fit
    assert not solved
    search.from_stated(fit, prepared, stated_with(fit, 2.0), "device")
    assert solved


@pytest.mark.parametrize("effect, is_near", [("bias", True), ("stribeck", False)])
def test_an_effect_without_values_has_nowhere_else_to_begin_if_it_has_but_a_strength(
    fitted, effect, is_near
):
    _, fit = fitted
    stated = fit.model.without_effect(effect).with_effect(effect)
    assert (effect, "device") in stated.absent
    assert is_at_stated(fit, stated, "device") is is_near


def test_parameters_that_are_held_do_not_count(fitted):
    _, fit = fitted
    held = tuple(n for n in free_parameters(fit.model) if n != "device.coulomb.level")
    assert is_at_stated(replace(fit, free=held), stated_with(fit, 2.0), "device")

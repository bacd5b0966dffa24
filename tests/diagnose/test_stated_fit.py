"""A fit of a model that is stated without values reaches the true values of its effects."""

import pytest
from diagnose.simulated_cases import write_simulated

import teleopdesign as td
from teleopdesign.diagnose.fit import estimate, fit_squares
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.diagnose.stated_fit import estimate_stated
from teleopdesign.measurement.prepare import prepare


def anew(model, *names):
    """The model with these of its effects without values."""
    for name in names:
        model = model.without_effect(name).with_effect(name)
    return model


@pytest.fixture(scope="module")
def lacking(tmp_path_factory):
    """Records of a machine with Stribeck's fall, as they are compared, and the user's model."""
    folder = write_simulated(tmp_path_factory.mktemp("stribeck") / "case", "stribeck")
    experiment = td.load_experiment(folder)
    return prepare(experiment), td.Model.from_experiment(experiment)


@pytest.mark.slow
def test_effects_without_values_explain_what_they_do_where_they_are_added_one_by_one(lacking):
    prepared, model = lacking
    without = anew(model, "coulomb", "viscous")
    added = without.with_effect("stribeck").with_effect("presliding")
    fit = estimate_stated(added, prepared)
    beside = estimate_from_starts(
        (start := estimate_from_starts(without, prepared)).model.with_effect("stribeck"),
        prepared,
        start,
    )
    assert fit_squares(fit) <= 1.01 * fit_squares(beside)
    assert set(fit.model.effects) == set(added.effects)


@pytest.mark.slow
def test_an_effect_at_the_end_of_its_search_range_begins_anew_beside_a_candidate(lacking):
    """At an endless Stribeck speed the law is one more Coulomb level: no search returns."""
    prepared, model = lacking
    endless = {"extra_static_level": 1e-3, "stribeck_velocity": 1e12}
    stuck = estimate(model.with_effect("stribeck", values=endless), prepared)
    assert stuck.at_bound == ("device.stribeck.stribeck_velocity",)
    beside = estimate_from_starts(stuck.model.with_effect("bias"), prepared, stuck, worth=0.0)
    assert fit_squares(beside) < 0.1 * fit_squares(stuck)
    assert not beside.at_bound

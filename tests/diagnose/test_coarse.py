"""The search for effects on few samples has the results of a search on all samples."""

import pytest
from diagnose.simulated_cases import FEW, truth_of, write_simulated

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose.error import force_error
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.search import base_of
from teleopdesign.measurement.prepare import prepare


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    """Prepared records of a body with a late actuator, the user's model, and the true one."""
    folder = write_simulated(tmp_path_factory.mktemp("coarse") / "case", "actuator_lag")
    experiment, truth = load_experiment(folder), truth_of(folder)
    stated = Model.from_experiment(experiment, FEW).with_values(truth["model_parameters"])
    (hidden,) = truth["effects"]
    values = {f"device.actuator_lag.{n}": p["value"] for n, p in hidden["parameters"].items()}
    true = stated.with_effect(stated.known["actuator_lag"], at="device").with_values(values)
    # half of the bandwidth: so there are samples to spare at each rate that a case may have
    return prepare(experiment, bandwidth=30.0), stated, true


def test_few_samples_hold_what_all_of_them_hold(case):
    prepared, stated, true = case
    coarse = prepared.coarse
    assert sum(len(s.motion.time) for s in coarse.stretches) <= 0.5 * sum(
        len(s.motion.time) for s in prepared.of("fit")
    )
    for model in (stated, true):
        few, all_of_them = (force_error(model, p.of("fit")) for p in (coarse, prepared))
        # reversals fall between samples: 0.8 % of the force here
        assert few == pytest.approx(all_of_them, abs=0.012)


def test_the_optimum_of_a_base_on_few_samples_is_next_to_that_on_all(case):
    prepared, stated, _ = case
    fit = estimate(stated, prepared)
    base = base_of(fit, prepared)
    for name in fit.free:
        here, there = base.coarse.model.parameters[name], fit.model.parameters[name]
        assert here.value == pytest.approx(there.value, rel=0.01)

"""The search for effects on few samples has the results of a search on all samples."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from diagnose.simulated_cases import FEW, truth_of, write_simulated

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose.error import force_error
from teleopdesign.diagnose.fit import estimate, fit_squares
from teleopdesign.diagnose.record_shift import record_shifts
from teleopdesign.diagnose.residual import residuals
from teleopdesign.diagnose.search import base_of
from teleopdesign.measurement.prepare import SOUGHT, prepare
from teleopdesign.realise import compiled, scan, shape_scan


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


def test_a_held_command_is_the_same_force_at_the_samples_that_are_left(case):
    prepared, *_ = case
    for few, whole in zip(prepared.coarse.stretches, prepared.of("fit"), strict=True):
        here = few.motion.at_rows(few.motion.command)
        there = whole.motion.at_rows(whole.motion.command)[:: few.motion.merged]
        # but for the ends, where records are continued: the smoothing leaves little above its edge
        inner = slice(len(here) // 10, -len(here) // 10)
        assert np.std((here - there)[inner]) < 5e-3 * np.std(there)


def test_rows_of_a_record_stay_what_they_are_on_few_samples(case):
    prepared, *_ = case
    few, whole = prepared.coarse.of("fit"), prepared.of("fit")
    assert record_shifts(few, 10).row == pytest.approx(record_shifts(whole, 10).row)
    for one, other in zip(few, whole, strict=True):
        assert one.weight * len(one.keep) == pytest.approx(other.weight * len(other.keep))
        # what stands for the record's own measured force does so on few samples too
        assert one.measured == pytest.approx(other.measured, rel=0.01)


def test_the_optimum_of_a_base_on_few_samples_is_next_to_that_on_all(case):
    prepared, stated, _ = case
    fit = estimate(stated, prepared)
    base = base_of(fit, prepared)
    for name in fit.free:
        here, there = base.coarse.model.parameters[name], fit.model.parameters[name]
        assert here.value == pytest.approx(there.value, rel=0.01)


def test_what_few_samples_leave_more_hides_no_gain(case):
    prepared, stated, _ = case
    base = base_of(estimate(stated, prepared), prepared)
    louder = replace(base, coarse=replace(base.coarse, fit_residual=3 * base.coarse.fit_residual))
    gain = fit_squares(louder.coarse) - louder.least(0.1)
    # nine times the squares on few samples: a tenth of those of the records still counts
    assert gain == pytest.approx(0.1 * fit_squares(base.fit))


def test_records_without_samples_to_spare_are_sought_on_themselves(case):
    prepared, stated, _ = case
    rate = 1.0 / prepared.stretches[0].motion.sample_time
    dense = prepare(prepared.experiment, bandwidth=1.01 * rate / (2.0 * SOUGHT))
    assert dense.coarse is dense
    fit = estimate(stated, dense)
    assert base_of(fit, dense) == replace(base_of(fit, dense), fit=fit, coarse=fit)


def test_each_kernel_is_compiled_once_for_few_samples_and_for_all(case, monkeypatch):
    prepared, _, true = case
    model = true.with_effect(true.known["presliding"], at="device", values={"stiffness": 1e4})
    kernels = Counter()

    def counted(source, function):
        kernel = compiled.compile_source(source, function)
        kernels[kernel] += 1
        return kernel

    for module in (scan, shape_scan):
        monkeypatch.setattr(module, "compile_source", counted)
    every = tuple(model.parameters)
    residuals(model, prepared.of("fit"), every)
    # a kernel may hold what other tests compiled
    first = {kernel: tuple(kernel.signatures) for kernel in kernels}
    for stretches in (prepared.of("fit"), prepared.coarse.of("fit")):
        for names in ((), every, ("device.inertia",)):
            residuals(model, stretches, names)
    assert len(kernels) == 2 and min(kernels.values()) >= 7  # a lag, and bristles
    assert {kernel: tuple(kernel.signatures) for kernel in kernels} == first

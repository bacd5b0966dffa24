"""On machines of the independent simulator: what it hides is said; where nothing, nothing is."""

from dataclasses import replace

import pytest
from diagnose.simulated_cases import FEW, truth_of, write_simulated
from unexplained.planting import written

from teleopdesign import Model, load_experiment
from teleopdesign.diagnose import find_missing
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.measurement.prepare import prepare
from teleopdesign.unexplained import describe_residual

WORDS = {
    "viscous": ("damping",),
    "coulomb": ("friction",),
    "stribeck": ("friction over speed",),
    "bias": ("force",),
    "spring": ("force over position",),
    "actuation_delay": ("lateness",),
    "viscous_asymmetry": ("force over speed", "force over velocity"),
    "position_dependent_friction": ("friction over position", "friction repeating over position"),
    "load_dependent_friction": ("friction over load",),
    "friction_drift": ("friction over time",),
    "actuator_saturation": ("force over actuator_force",),
    "torque_ripple": ("lost command over position", "lost command repeating over position"),
}


@pytest.mark.slow
@pytest.mark.parametrize("effect", WORDS)
def test_what_the_independent_simulator_hides_is_reported(tmp_path, effect):
    folder = write_simulated(tmp_path / "case", effect, seed=21)
    prepared = prepare(load_experiment(folder))
    fit = estimate_from_starts(Model.from_experiment(prepared.experiment), prepared)
    assert describe_residual(fit, prepared).largest[1].dependence.shape.name in WORDS[effect]


@pytest.mark.slow
def test_where_the_independent_simulator_hides_nothing_nothing_is_reported(tmp_path):
    for seed in range(1000, 1003):
        folder = write_simulated(tmp_path / str(seed), None, seed=seed)
        prepared = prepare(load_experiment(folder))
        fit = estimate_from_starts(Model.from_experiment(prepared.experiment), prepared)
        assert describe_residual(fit, prepared).largest is None, seed


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_a_force_outside_the_catalogue_is_described_written_and_named(tmp_path, seed):
    folder = write_simulated(tmp_path / "case", None, seed=300 + seed, level="outside")
    experiment = load_experiment(folder)
    prepared = prepare(experiment)
    model = Model.from_experiment(experiment)
    effect = written(
        tmp_path, "found", describe_residual(estimate(model, prepared), prepared), prepared
    )
    # among all of the catalogue it takes six times as long
    few = FEW | {name: model.known[name] for name, _ in model.effects}
    known = {**few, "found": effect}
    diagnosis = find_missing(experiment, replace(model, known=known))
    assert "found" in [c.effect.name for c in diagnosis.missing]
    # within half of the true model's error; a hum's form is exact, others to the floor's spread
    assert diagnosis.after.check_error < 1.5 * truth_of(folder)["check_error_true"]

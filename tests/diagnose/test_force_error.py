"""The force error and its floor: figures that anyone can recompute."""

import importlib.util
from dataclasses import replace

import numpy as np
import pytest
from diagnose.simulated_cases import truth_of, write_simulated
from shared_data import shared_folder

from teleopdesign import ExperimentError, Model, example, load_experiment
from teleopdesign.diagnose.error import force_error
from teleopdesign.diagnose.fit import block_numbers, estimate
from teleopdesign.diagnose.folds import folds
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.diagnose.predictions import write_predictions
from teleopdesign.diagnose.residual import relative_residuals, residuals
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.prepare import prepare
from teleopdesign.realise.along_motion import residual_along


@pytest.fixture(scope="module")
def prepared(experiment):
    return prepare(experiment)


@pytest.fixture(scope="module")
def model(experiment):
    return Model.from_experiment(experiment)


def test_the_error_is_that_of_the_plain_formula(prepared, model):
    """rms(LP r) / rms(LP (u + f)) of the check record less 0.25 s at each end, by hand."""
    (stretch,) = prepared.of("check")
    m = stretch.motion
    inside = slice(int(0.25 / m.sample_time), -int(0.25 / m.sample_time))
    left = m.lowpassed(residual_along(model.body("device"), m).residual.value)[inside]
    record = prepared.experiment.check_records[0]
    force = record.signals["device.actuator_force"] + record.signals.get(
        "device.interaction_force", 0.0
    )
    by_hand = np.sqrt(np.mean(left**2) / np.mean(m.lowpassed(force)[inside] ** 2))
    # rows are thinned to five a period of the bandwidth; the command is taken half a sample late
    assert force_error(model, prepared.of("check")) == pytest.approx(by_hand, rel=0.01)


@pytest.mark.slow
def test_the_error_can_be_recomputed_from_the_predictions(diagnosis, tmp_path):
    file = tmp_path / "predictions.csv.gz"
    write_predictions(diagnosis, file)
    spec = importlib.util.spec_from_file_location("score", shared_folder("hidden/score.py"))
    score = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(score)
    error, problem = score.recompute(file, diagnosis.prepared.bandwidth)
    assert problem is None
    # thinning and the half sample of the held command
    assert error == pytest.approx(diagnosis.after.check_error, rel=0.01)


def test_the_true_parameters_leave_the_error_that_the_simulation_says(
    prepared, model, stribeck_case
):
    truth = truth_of(stribeck_case)
    values = dict(truth["model_parameters"])
    (hidden,) = truth["effects"]
    known = model.with_effect(
        "stribeck", values={n: v["value"] for n, v in hidden["parameters"].items()}
    ).with_values(values)
    error = force_error(known, prepared.of("check"))
    # the reference knows where a motion reverses. Where an encoder cannot tell, static friction
    # takes up a part of the noise; elsewhere the measured motion leaves a little more
    assert 0.8 * truth["check_error_true"] < error < 1.5 * truth["check_error_true"]
    base = estimate(model, prepared)
    assert base.check_error == pytest.approx(truth["check_error_base"], rel=0.1)
    assert base.fit_error == pytest.approx(truth["fit_error_base"], rel=0.1)


# the floor


@pytest.mark.parametrize(
    ("effect", "seed"),
    [
        pytest.param("stribeck", 8, marks=pytest.mark.slow),
        (None, 4),
        pytest.param("spring", 8, marks=pytest.mark.slow),
    ],
)
def test_the_floor_is_what_step_and_noise_leave_on_the_true_motion(effect, seed, tmp_path):
    """Within 30 % of the floor that the simulator finds by drawing errors onto its true motion."""
    folder = write_simulated(tmp_path / "case", effect, seed=seed)
    truth = truth_of(folder)
    prepared = prepare(load_experiment(folder))
    model = Model.from_experiment(prepared.experiment)
    if effect:
        (hidden,) = truth["effects"]
        values = {n: v["value"] for n, v in hidden["parameters"].items()}
        model = model.with_effect(effect, values=values)
    model = model.with_values(truth["model_parameters"])
    floor = noise_floor(model, prepared, np.random.default_rng(0))
    assert floor.source == "stated resolution and noise"
    # below it: a friction that balances where no motion is told takes up noise with it
    assert 0.65 < floor.value / truth["noise_floor"] < 1.3


@pytest.mark.parametrize("seed", [1, *(pytest.param(k, marks=pytest.mark.slow) for k in (2, 3))])
def test_a_right_model_lies_at_its_floor(seed, tmp_path):
    folder = write_simulated(tmp_path / "case", None, seed=seed)
    experiment = load_experiment(folder)
    prepared = prepare(experiment)
    fit = estimate_from_starts(Model.from_experiment(experiment), prepared)
    floor = noise_floor(fit.model, prepared, np.random.default_rng(0))
    # on 268 other records: 0.97 to 1.22, the middle nine tenths
    assert 0.75 < fit.check_error / floor.value < 1.4


def test_a_hands_force_of_unstated_noise_raises_the_floor_by_what_its_readings_scatter(
    experiment, prepared, model
):
    """Beside an encoder whose step is stated: that says nothing of the hand's sensor."""
    name, rng = "device.interaction_force", np.random.default_rng(3)
    sigma = 0.1 * np.std(experiment.records[0].signals["device.actuator_force"])
    records = tuple(
        replace(
            r,
            signals={
                **r.signals,
                name: sigma * rng.standard_normal(len(r.signals["device.position"])),
            },
        )
        for r in experiment.records
    )
    floors = []
    for noise in (sigma, None):
        hand = Channel("interaction_force", "device", "f_h", "N", None, noise)
        touched = replace(experiment, records=records, channels={**experiment.channels, name: hand})
        floors.append(noise_floor(model, prepare(touched), np.random.default_rng(0)))
    stated, from_readings = floors
    assert from_readings.source == "stated resolution, noise of forces estimated from the readings"
    assert from_readings.value == pytest.approx(stated.value, rel=0.15)
    untouched = noise_floor(model, prepared, np.random.default_rng(0))
    assert from_readings.value > 1.5 * untouched.value


# what is compared


def test_a_bandwidth_too_high_for_the_samples_is_one_line(experiment):
    with pytest.raises(ExperimentError, match="bandwidth: 450 Hz is too high for fit.csv.gz"):
        prepare(experiment, bandwidth=450.0)


def test_segments_are_separate_stretches(experiment, model):
    """Cut in three, what remains of the record leaves the same error but for its ends."""
    whole = experiment.fit_records[0]
    n = len(whole.time)
    cuts = (slice(0, n // 3), slice(n // 3, 2 * n // 3), slice(2 * n // 3, n))
    cut = replace(whole, segments=cuts)
    parts = prepare(replace(experiment, records=(cut,)))
    assert [s.motion.rows for s in parts.of("fit")] == list(cuts)
    numbers = block_numbers(parts.of("fit"))
    assert np.all(np.diff(numbers) >= 0) and len(np.unique(numbers)) == numbers[-1] + 1
    one = prepare(replace(experiment, records=(whole,)))
    # 1 s of 12 is left out at the cuts
    assert force_error(model, parts.of("fit")) == pytest.approx(
        force_error(model, one.of("fit")), rel=0.1
    )


@pytest.mark.parametrize("beside", [{}, {"friction_memory": {"time_constant": 0.01}}])
def test_a_friction_that_takes_up_whatever_acts_gains_nothing(beside):
    """At mu near 1 next to no force is left to move the rod, and next to no residual."""
    experiment = load_experiment(example("rod"))
    stretches = prepare(experiment).of("fit")
    stated = Model.from_experiment(experiment).with_effect(
        "stribeck", values={"extra_static_level": 0.2, "stribeck_velocity": 0.02}
    )
    for effect, values in beside.items():
        stated = stated.with_effect(effect, values=values)
    name = "device.load_dependent_friction.coefficient"

    def squares(mu, of):
        model = stated.with_effect("load_dependent_friction", values={"coefficient": mu})
        ((r, slope),) = of(model, stretches, [name])
        return float(r @ r), 2.0 * float(slope[0] @ r)

    plain, (little, _) = squares(0.0, residuals)[0], squares(0.9, relative_residuals)
    assert little > plain
    value, slope = squares(0.3, relative_residuals)
    ahead, back = (squares(0.3 + h, relative_residuals)[0] for h in (1e-5, -1e-5))
    assert slope == pytest.approx((ahead - back) / 2e-5, rel=1e-3)


@pytest.mark.parametrize("use", ["fit", "check"])
def test_records_without_any_force_are_refused(use, experiment):
    """The error is relative to the measured force: there would be none."""
    zeros = {"device.actuator_force": 0.0, "device.interaction_force": 0.0}
    records = [
        replace(r, signals={n: s * zeros.get(n, 1.0) for n, s in r.signals.items()})
        if r.use == use
        else r
        for r in experiment.records
    ]
    with pytest.raises(ExperimentError, match=f"{use} records: the measured force"):
        prepare(replace(experiment, records=tuple(records)))


def test_records_with_too_few_samples_for_blocks_are_refused_and_left_out_beside_others(experiment):
    """Blocks are held out in turn where there is no check record: each needs a sample."""
    (record,) = experiment.fit_records
    with pytest.raises(ExperimentError, match="fewer than 4 samples count at a bandwidth of 0.05"):
        prepare(replace(experiment, records=(record,)), bandwidth=0.05)
    prepared = prepare(replace(experiment, records=(record,)), bandwidth=1.0)
    for fold in folds(prepared.stretches):
        assert all(len(s.keep) for s in (*fold.known, *fold.held_out))


@pytest.mark.parametrize("channel", ["position", "actuator_force"])
def test_a_signal_whose_cubes_are_no_numbers_is_refused_by_its_channel(channel, experiment):
    (record,) = experiment.fit_records
    signals = {n: s * (1e90 if channel in n else 1.0) for n, s in record.signals.items()}
    huge = replace(experiment, records=(replace(record, signals=signals),))
    with pytest.raises(ExperimentError, match=rf"channels.device.{channel}: found .*e\+.* \(SI\)"):
        prepare(huge)

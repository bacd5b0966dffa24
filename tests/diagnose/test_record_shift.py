"""A shift between the rows of force and position belongs to the record: found with every model."""

import json
from dataclasses import replace

import numpy as np
import pytest
from diagnose.simulated_cases import FEW, truth_of, write_simulated
from scipy.signal import lfilter

import teleopdesign as td
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.ladder_state import restrict_candidates
from teleopdesign.diagnose.model_data import model_data, model_from
from teleopdesign.diagnose.record_shift import shifts_of
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.diagnose.stated_fit import with_late_starts, with_paying_shift
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare


def shifted(experiment, rows):
    """The experiment as a logger writes it whose commands are late by so many rows (< 0: early).

    A part of a row is an average of what two rows hold, as a staircase that is sampled between.
    """
    whole, part = divmod(rows, 1.0)

    def late(signal):
        one, two = (np.roll(signal, int(whole) + k) for k in (0, 1))
        return (1.0 - part) * one + part * two

    def logged(record):
        signals = {
            n: (late(y) if n.endswith("actuator_force") else y)[2:-2]
            for n, y in record.signals.items()
        }
        segments = (slice(0, len(record.time) - 4),)
        return replace(record, time=record.time[2:-2], signals=signals, segments=segments)

    return replace(experiment, records=tuple(logged(r) for r in experiment.records))


def fitted(experiment, *effects, model=None):
    """The model of the experiment, with these effects more, estimated on its records."""
    model = model or td.Model.from_experiment(experiment)
    for name in effects:
        model = model.with_effect(name, at=next(iter(model.bodies)))
    return estimate_from_starts(model, prepare(experiment))


def rows_late(fit, experiment):
    (late,) = fit.model.record_shift.values()
    row = experiment.records[0].sample_time
    return late.value / row, late.stderr / row


#: the ten, and what a late log was once mistaken for
MISTAKEN = (*FEW, "transmission_compliance")
#: forces that repeat along the travel
WAVES = ("cogging", "cogging_harmonic", "torque_ripple")


@pytest.fixture(scope="module")
def adequate(tmp_path_factory):
    """A simulated device whose model is right."""
    return td.load_experiment(write_simulated(tmp_path_factory.mktemp("own") / "null", None))


@pytest.fixture(scope="module")
def plain(adequate):
    """Its model, estimated."""
    return fitted(adequate)


@pytest.mark.parametrize("rows", [1.0, -1.0, -0.3, 0.3])
def test_a_shift_is_detected_and_costs_nothing(adequate, plain, rows):
    late = fitted(shifted(adequate, rows))
    lateness, error = rows_late(late, adequate)
    before, _ = rows_late(plain, adequate)
    # the simulated actuator holds its command without any delay, so the clock is right
    assert abs(before) < 0.05
    assert lateness - before == pytest.approx(rows, abs=0.03)
    assert error < 0.05
    # a part of a row is logged as an average of two, which the model knows only in its first order
    assert late.check_error == pytest.approx(plain.check_error, rel=0.02)


def test_a_delay_of_several_rows_is_no_clock(adequate):
    late = shifted(shifted(adequate, -2.0), -2.0)
    row = late.records[0].sample_time
    without, with_delay = fitted(late), fitted(late, "actuation_delay")
    lateness, _ = rows_late(without, late)
    assert lateness == pytest.approx(-1.1, abs=1e-3)
    assert with_delay.check_error < 0.5 * without.check_error
    (place,) = with_delay.model.bodies
    delay = with_delay.model.parameters[f"{place}.actuation_delay.delay"]
    assert delay.value == pytest.approx(4.0 * row, abs=0.1 * row)
    # a row more or less may be the logger's
    assert 0.3 * row < delay.stderr < 0.7 * row


def test_what_a_controller_makes_of_a_shift_is_left_open(adequate):
    """Under a spring and damper alone a late command is one of other damping: both are in doubt."""
    model = td.Model.from_experiment(adequate)
    (place,) = model.bodies
    inertia, damping, stiffness, rate = 0.2, 2.0, 500.0, 5.0
    values = {f"{place}.inertia": inertia, f"{place}.viscous.damping": damping}
    model = model.with_values({**values, f"{place}.coulomb.level": 1e-6})
    noise = np.random.default_rng(3)

    def led(record):
        def course(t):
            waves = [(0.3 / k, 2 * np.pi * f) for k, f in enumerate((0.5, 1.3, 2.1), 1)]
            x = sum(a * np.sin(w * t + w) for a, w in waves)
            v = sum(a * w * np.cos(w * t + w) for a, w in waves)
            return x, v, -sum(a * w**2 * np.sin(w * t + w) for a, w in waves)

        x, v, acceleration = course(record.time)
        # what is held until the next row acts half a row later than it is logged
        held, held_rate, _ = course(record.time - 0.5 * record.sample_time)
        acts = -stiffness * held - rate * held_rate
        hand = inertia * acceleration + damping * v - acts
        signals = {
            f"{place}.position": x,
            f"{place}.actuator_force": -stiffness * x - rate * v,
            f"{place}.interaction_force": hand + 0.5 * noise.standard_normal(len(x)),
        }
        return replace(record, signals=signals)

    experiment = replace(adequate, records=tuple(led(r) for r in adequate.records))
    fit = estimate(model, prepare(experiment))
    lateness, error = rows_late(fit, experiment)
    # half a row is what is known of a clock beforehand: no more is learned from such a record
    assert abs(lateness) < 2 * error
    assert 0.3 < error < 0.6
    viscous_damping = fit.model.parameters[f"{place}.viscous.damping"]
    assert viscous_damping.value == pytest.approx(damping, abs=2 * viscous_damping.stderr)
    # half a row of a spring's force is that much damping
    assert viscous_damping.stderr == pytest.approx(
        0.5 * experiment.records[0].sample_time * stiffness, rel=0.4
    )


def only_late(experiment, rows, use):
    """The experiment with the records of one use late by so many rows."""
    late = shifted(experiment, rows).records
    pairs = zip(experiment.records, late, strict=True)
    return replace(experiment, records=tuple(b if a.use == use else a for a, b in pairs))


@pytest.mark.parametrize("rows", [-1.0, 1.0])
def test_a_shift_that_raises_the_error_on_unseen_records_is_held_at_none(adequate, rows):
    """What only the fit records have: to take up a part of what is missing there looks the same."""
    experiment = only_late(adequate, rows, "fit")
    prepared = prepare(experiment)
    free = fitted(experiment)
    assert abs(rows_late(free, experiment)[0]) > 0.9
    held = with_paying_shift(free, prepared)
    assert held.check_error < free.check_error
    assert rows_late(held, experiment)[0] == 0.0
    # what is left open of the clock stays in all standard errors
    assert rows_late(held, experiment)[1] > 0.0 and held.by_shift.shape == free.by_shift.shape
    # and it stays so with what is added
    (place,) = held.model.bodies
    beside = estimate(held.model.with_effect("bias", at=place), prepared)
    assert rows_late(beside, experiment)[0] == 0.0
    data = json.loads(json.dumps(model_data(held.model)))
    back = model_from(data, EFFECTS, "models")
    assert back.record_shift[place] == held.model.record_shift[place]


@pytest.mark.slow
def test_beside_a_gain_a_late_command_is_compared_with_a_dead_time(tmp_path):
    """In the place of a shift at its bound a dead time is tried, of an effect that is not there."""
    experiment = td.load_experiment(write_simulated(tmp_path / "late", "actuation_delay"))
    fit = fitted(experiment, "actuator_gain")
    # no effect with a dead time is known: it was looked for in the gain, and that one added again
    fit = replace(fit, model=restrict_candidates(["actuator_gain"], fit.model))
    assert with_paying_shift(fit, prepare(experiment)).model.effects == fit.model.effects


def logged_late(experiment, rows):
    """The experiment whose log holds commands back by whole rows."""
    for _ in range(rows):
        experiment = shifted(experiment, 1.0)
    return experiment


@pytest.mark.slow
@pytest.mark.parametrize("rows", [9])
def test_a_log_that_is_many_rows_late_is_no_physics(adequate, plain, rows):
    """Nothing moves before its command: from a log in time the search ends in a poor fit."""
    experiment = logged_late(adequate, rows)
    prepared = prepare(experiment)
    stated = td.Model.from_experiment(experiment)
    fit = with_late_starts(fitted(experiment), stated, prepared)
    assert rows_late(fit, experiment)[0] == pytest.approx(rows, abs=0.1)
    assert fit.check_error == pytest.approx(plain.check_error, rel=0.05)
    (shift,) = shifts_of(fit.model, prepared.stretches)
    assert "the log is late" in str(shift) and not shift.at_bound


def sensed(experiment, seconds):
    """The experiment with forces that a sensor filtered, by a first-order low-pass."""

    def logged(record):
        late = 1.0 - np.exp(-record.sample_time / seconds)
        signals = {
            n: lfilter([late], [1.0, late - 1.0], y) if n.endswith("_force") else y
            for n, y in record.signals.items()
        }
        return replace(record, signals=signals)

    channels = {
        n: replace(c, measured=True) if n.endswith("actuator_force") else c
        for n, c in experiment.channels.items()
    }
    records = tuple(logged(r) for r in experiment.records)
    return replace(experiment, records=records, channels=channels)


@pytest.mark.parametrize("rows", [2.5, 6.0])
def test_the_filter_of_a_force_sensor_is_no_physics(adequate, plain, rows):
    experiment = sensed(adequate, rows * adequate.records[0].sample_time)
    fit = fitted(experiment)
    lateness, _ = rows_late(fit, experiment)
    # what a low-pass does to slow signals is a delay by its time constant
    assert lateness == pytest.approx(rows, rel=0.25)
    (shift,) = shifts_of(fit.model, prepare(experiment).stretches)
    assert "filter of its sensor" in str(shift) and not shift.at_bound
    (place,) = fit.model.bodies
    inertia = plain.model.parameters[f"{place}.inertia"].value
    assert fit.model.parameters[f"{place}.inertia"].value == pytest.approx(inertia, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "rows", "among"), [(12, 1.0, MISTAKEN)])
def test_no_effect_is_named_for_a_logger_that_is_off(tmp_path, seed, rows, among):
    experiment = td.load_experiment(write_simulated(tmp_path / "null", None, seed=seed))
    assert not td.find_missing(shifted(experiment, rows), among=among).missing


@pytest.mark.slow
@pytest.mark.parametrize(("effect", "rows"), [("presliding", 1.0)])
def test_an_effect_keeps_its_name_under_a_shift(tmp_path, effect, rows):
    folder = write_simulated(tmp_path / effect, effect)
    late = shifted(td.load_experiment(folder), rows)
    diagnosis = td.find_missing(late, among=(*FEW, *WAVES))
    named = [c.effect.name for c in diagnosis.missing]
    assert named == [e["effect"] for e in truth_of(folder)["effects"]]

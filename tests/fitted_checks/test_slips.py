"""Slips that a recording tells without a model: clocks, swapped columns, scales, other names."""

from dataclasses import replace

import numpy as np
import pytest
from check.made_channels import ask
from fitted_checks.asking import disagreements

import teleopdesign as td
from teleopdesign.cli import main
from teleopdesign.fitted_checks import check_experiment
from teleopdesign.measurement.prepare import prepare
from teleopdesign.model import Model


@pytest.fixture(scope="module")
def rod():
    return td.load_experiment(td.example("rod"))


def changed(experiment, signals):
    records = tuple(replace(r, signals=signals(dict(r.signals))) for r in experiment.records)
    return replace(experiment, records=records)


def test_a_time_in_ms_that_is_read_as_s_is_named(rod):
    slow = tuple(
        replace(r, time=1e3 * r.time, sample_time=1e3 * r.sample_time) for r in rod.records
    )
    findings = ask("sample_clock", replace(rod, records=slow))
    assert 'write unit = "ms" at channels.time' in findings[0].sentence
    assert [f.concern for f in ask("sample_clock", rod)] == ["fine"]


@pytest.mark.slow
@pytest.mark.parametrize(("channel", "factor"), [("interaction", 0.6), ("actuator", 1.7)])
def test_forces_of_two_scales_are_a_note_that_says_what_to_type(rod, channel, factor):
    """The scale that is printed is the one that was put in; a calibration is no note."""
    key = f"device.{channel}_force"
    wrong = changed(rod, lambda s: s | {key: factor * s[key]})
    (note,) = [f for f in check_experiment(wrong) if f.topic == "force scales"]
    # the force that leads may be either of the two
    expected = factor if channel == "actuator" else 1 / factor
    gain = note.numbers["gain"]
    assert min(abs(gain - expected), abs(gain - 1 / expected)) < 0.05 * gain
    assert f"scale = {gain:.4g} at channels." in note.sentence
    assert not [f for f in check_experiment(rod) if f.topic == "force scales"]


def joint(factor):
    """A joint of 0.02 kg*m^2 and 0.3 N*m, its angle as a log with a slip of units has it."""
    t = np.arange(6000) / 500
    q = 0.6 * np.sin(2 * t) + 0.2 * np.sin(7.3 * t)
    v = 1.2 * np.cos(2 * t) + 1.46 * np.cos(7.3 * t)
    u = 0.02 * (-2.4 * np.sin(2 * t) - 10.658 * np.sin(7.3 * t)) + 0.3 * np.sign(v)
    columns = {"t": t, "q": factor * q, "u": u}
    names = {"time": "t", "position": "q", "actuator_force": "u"}
    units = {"t": "s", "q": "rad", "u": "N*m"}
    experiment = td.experiment(columns, axis="revolute", units=units, **names)
    model = Model.from_experiment(experiment)
    known = {"device.inertia": 0.0202, "device.coulomb.level": 0.3, "device.viscous.damping": 0.001}
    return model.with_values(known), prepare(experiment)


def test_a_position_in_turns_that_is_given_as_radians_is_named():
    (finding,) = disagreements(*joint(1 / (2 * np.pi)))
    assert (
        finding.concern == "note" and "the position is in turns, given as rad" in finding.sentence
    )
    (right,) = disagreements(*joint(1.0))
    assert right.concern == "fine" and "signs and units agree" in right.sentence


def test_units_do_not_agree_with_an_inertia_of_the_same_records():
    _, prepared = joint(1.0)
    (finding,) = disagreements(Model.from_experiment(prepared.experiment), prepared)
    assert "signs agree" in finding.sentence and "signs and units" not in finding.sentence


@pytest.mark.parametrize("times", [0.2, 3.0])
def test_an_inertia_several_times_the_models_is_no_agreement(times):
    model, prepared = joint(1.0)
    wrong = model.with_values({"device.inertia": 0.02 / times})
    (finding,) = disagreements(wrong, prepared)
    assert finding.concern == "note" and "times the model's" in finding.sentence
    assert "turns" not in finding.sentence
    assert finding.numbers["ratio.inertia"] == pytest.approx(times, rel=0.1)


def test_forces_of_another_scale_are_named_beside_first_values_that_are_guesses():
    model, prepared = joint(1.0)
    rough = {"device.inertia": 1.2, "device.coulomb.level": 12.0, "device.viscous.damping": 0.02}
    (finding,) = disagreements(model.with_values(rough), prepared)
    assert finding.concern == "warning" and "a torque constant or a gear ratio" in finding.sentence


def test_columns_that_do_not_read_are_a_finding_where_the_log_tells_why(tmp_path, capsys, rod):
    record = rod.fit_records[0]
    rows = np.column_stack(
        [
            1e3 * record.time,
            record.signals["device.position"],
            record.signals["device.actuator_force"],
        ]
    )[:3000]
    head = "time_ms,pos_m,force_N"
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header=head, comments="")
    (tmp_path / "experiment.toml").write_text(
        '[model.device]\naxis = "prismatic"\ninertia = 0.2\n[model.device.effects]\n[channels]\n'
        'time = { column = "pos_m", unit = "s" }\nposition = { column = "time_ms", unit = "m" }\n'
        'actuator_force = { column = "force_N", unit = "N" }\n'
        '[[records]]\nfile = "log.csv"\nuse = "fit"\n'
    )
    assert main(["check", str(tmp_path)]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert 'channels.time: the log looks like column = "time_ms", found "pos_m"' in shown

"""From raw logs to a diagnosis: each gives the answer of the clean record."""

import numpy as np
import pytest
from measurement.wild_logs import LOGS, STEP, clean, data_frame

import teleopdesign as td
from teleopdesign.cli import main
from teleopdesign.effects import EFFECTS

FEW = ("coulomb", "viscous", "stribeck", "quadratic_drag", "bias")


@pytest.fixture(scope="module")
def log():
    return clean()


def diagnosis_of(experiment):
    known = {name: EFFECTS[name] for name in FEW}
    return td.find_missing(experiment, td.Model.from_experiment(experiment, known))


@pytest.fixture(scope="module")
def truth(log):
    experiment = td.experiment(
        log,
        axis="revolute",
        position={"column": "q", "unit": "rad", "resolution": STEP},
        actuator_force="u",
        interaction_force="hand",
        time="t",
        fit=[(0.0, 4.199)],
        check=[(4.199, 8.0)],
    )
    return diagnosis_of(experiment)


def from_log(make, folder, log, monkeypatch):
    monkeypatch.chdir(folder)
    paths, options = make(folder, log, np.random.default_rng(1))
    assert main(["new", *map(str, paths), "--yes", "--output", "joint", *options]) == 0
    return td.load_experiment("joint")


@pytest.mark.parametrize("make", LOGS, ids=lambda make: make.__name__)
def test_a_raw_log_is_understood_without_an_editor(make, tmp_path, log, monkeypatch, capsys):
    if make.__name__ == "ros_bag":
        pytest.importorskip("rosbags")
    experiment = from_log(make, tmp_path, log, monkeypatch)
    assert experiment.axis("device") == "revolute"
    assert experiment.channels["device.position"].resolution == pytest.approx(STEP, rel=1e-3)
    assert {r.use for r in experiment.records} == {"fit", "check"}
    rate = 500 if make.__name__ == "robot_log" else 1000
    for record in experiment.records:
        assert record.sample_time == pytest.approx(1 / rate, rel=1e-4)
    first = experiment.records[0]
    t = first.time - (5000.0 if make.__name__ == "robot_log" else 0.0)
    left = first.signals["device.position"] - np.interp(t, log["t"], log["q"])
    # the encoder's zero may be elsewhere; a reading that was taken between two errs by a step or so
    assert np.std(left) < STEP
    torque = experiment.records[0].signals["device.actuator_force"]
    assert np.std(torque) == pytest.approx(np.std(log["u"][:4199]), rel=0.03)
    assert (tmp_path / "joint" / "understood.png").stat().st_size > 10_000
    assert "written: joint/experiment.toml" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("make", [*LOGS, data_frame], ids=lambda make: make.__name__)
def test_a_raw_log_gives_the_answer_of_the_clean_record(make, tmp_path, log, truth, monkeypatch):
    if make is data_frame:
        names = {"position": "Pos (deg)", "actuator_force": "Torque (Nm)"}
        experiment = td.experiment(
            data_frame(log),
            axis="revolute",
            interaction_force="Hand (Nm)",
            fit=[(0.0, 4.199)],
            check=[(4.199, 8.0)],
            **names,
        )
    else:
        if make.__name__ == "ros_bag":
            pytest.importorskip("rosbags")
        experiment = from_log(make, tmp_path, log, monkeypatch)
    diagnosis = diagnosis_of(experiment)
    assert [c.key for c in diagnosis.missing] == [c.key for c in truth.missing]
    assert diagnosis.verdict == truth.verdict
    for name, value in truth.model.parameters.items():
        other = diagnosis.model.parameters[name]
        spread = np.hypot(value.stderr, other.stderr)
        # 3: both estimates scatter, and readings are not those of the clean record
        assert abs(other.value - value.value) < 3 * spread, name

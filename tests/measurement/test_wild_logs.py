"""From raw logs to a diagnosis: each gives the answer of the clean record."""

import json
from pathlib import Path

import numpy as np
import pytest
from measurement.wild_logs import LOGS, STEP, clean, data_frame

import teleopdesign as td
from teleopdesign.cli import main

#: effects that are tried: the one that is missing, and some that could stand for it
CANDIDATES = ("stribeck", "presliding", "quadratic_drag", "bias")


@pytest.fixture(scope="module")
def log():
    return clean()


def diagnosed(folder):
    """The answer of `teleopdesign diagnose FOLDER`, with a report beside it."""
    wishes = ["--only", *CANDIDATES, "--json", "answer.json", "--report", "report.html"]
    assert main(["diagnose", folder, *wishes]) == 0
    assert Path("report.html").stat().st_size > 100_000
    return json.loads(Path("answer.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def truth(log, tmp_path_factory):
    """The answer of the clean record."""
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
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("clean"))
        experiment.save("clean")
        return diagnosed("clean")


def from_log(make, folder, log, monkeypatch):
    monkeypatch.chdir(folder)
    paths, options = make(folder, log, np.random.default_rng(1))
    assert main(["new", *map(str, paths), "--yes", "--output", "joint", *options]) == 0
    return td.load_experiment("joint")


@pytest.mark.parametrize(
    "make",
    # bags are read in the plain run by `test_dvrk_bag.py` too, and take seconds to write
    [pytest.param(m, marks=[pytest.mark.slow] * (m.__name__ == "ros_bag")) for m in LOGS],
    ids=lambda make: make.__name__,
)
@pytest.mark.usefixtures("picture")
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
def test_two_commands_lead_from_a_raw_log_to_the_report_and_answer_of_the_clean_record(
    make, tmp_path, log, truth, monkeypatch
):
    """`new` and `diagnose`; for arrays one call that saves a folder, and `diagnose`."""
    if make is data_frame:
        monkeypatch.chdir(tmp_path)
        names = {"position": "Pos (deg)", "actuator_force": "Torque (Nm)"}
        td.experiment(
            data_frame(log),
            axis="revolute",
            interaction_force="Hand (Nm)",
            fit=[(0.0, 4.199)],
            check=[(4.199, 8.0)],
            **names,
        ).save("joint")
    else:
        if make.__name__ == "ros_bag":
            pytest.importorskip("rosbags")
        from_log(make, tmp_path, log, monkeypatch)
    answer = diagnosed("joint")
    assert answer["missing"] == truth["missing"] == [{"effect": "stribeck", "at": "device"}]
    assert answer["verdict"] == truth["verdict"]
    for here, there in zip(parameters(answer), parameters(truth), strict=True):
        (name, value), (also, other) = here, there
        assert name == also
        # within the 95 % interval that the raw log's answer states: a log of half the rows, as that
        # of the robot, knows less than the clean record
        assert abs(value["value"] - other["value"]) < 1.96 * value["stderr"], name


def parameters(answer):
    """(name, value) of every parameter of the model that the diagnosis ends with."""
    device = answer["models"]["ladder"][-1]["device"]
    of_effects = [
        (f"{effect}.{name}", value)
        for effect, values in sorted(device["effects"].items())
        for name, value in sorted(values.items())
    ]
    return [("inertia", device["inertia"]), *of_effects]

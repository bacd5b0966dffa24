"""The folder made of logs: which record is fitted, what the model starts from, and what is kept."""

import tomllib

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement import load_experiment
from teleopdesign.measurement.new_folder import make_folder
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log

H = 0.005
M, LEVEL, DAMPING = 0.4, 0.6, 2.0


def write_log(path, size=1.0):
    """A slider of 0.4 kg with friction of 0.6 N and 2 N s/m, 12 s."""
    t = H * np.arange(2400)
    x = size * (0.1 * np.sin(2 * np.pi * 0.6 * t) + 0.05 * np.sin(2 * np.pi * 1.9 * t + 1.0))
    v = np.gradient(x, t)
    force = M * np.gradient(v, t) + LEVEL * np.sign(v) + DAMPING * v
    table = np.column_stack([t, 1e3 * x, force, np.cos(t)])
    names = "time (s),position (mm),force command (N),temperature (degC)"
    np.savetxt(path, table, delimiter=",", header=names, comments="", fmt="%.9g")
    return path


@pytest.fixture
def log(tmp_path):
    return write_log(tmp_path / "run.csv")


def survey_of(path, axis="prismatic"):
    return survey_log(open_log(path, path.name), path.name, Choices(axis=axis))


def make(log, folder, *more, **choices):
    return make_folder(survey_of(log), [log, *more], folder, title='a "b"', **choices)


def written(folder):
    return tomllib.loads((folder / "experiment.toml").read_text())


def test_one_log_is_cut_into_fit_and_check_and_the_model_starts_from_the_fit(log, tmp_path):
    folder = make(log, tmp_path / "new" / "rod")
    assert folder == tmp_path / "new" / "rod"
    assert (folder / "run.csv").read_bytes() == log.read_bytes()
    content = written(folder)
    assert content["title"] == 'a "b"'
    fit, check = content["records"]
    assert (fit["use"], check["use"]) == ("fit", "check")
    assert fit["file"] == check["file"] == "run.csv"
    assert fit["span"][0] == 0.0 and fit["span"][1] == check["span"][0] < check["span"][1]
    device = content["model"]["device"]
    assert device["axis"] == "prismatic"
    inertia = device["inertia"]
    assert inertia["unit"] == "kg" and not inertia.get("fixed", False)
    assert inertia["value"] == pytest.approx(M, rel=0.05)
    assert float(f"{inertia['value']:.3g}") == inertia["value"]  # three digits of a start
    level = device["effects"]["coulomb"]["level"]
    assert level["unit"] == "N" and level["value"] == pytest.approx(LEVEL, rel=0.1)
    damping = device["effects"]["viscous"]["damping"]
    assert damping["unit"] == "N*s/m" and damping["value"] == pytest.approx(DAMPING, rel=0.1)
    text = (folder / "experiment.toml").read_text()
    assert "# forces in N, positions in m" in text and "# a start, from the log" in text
    assert '#   "temperature (degC)": ' in text
    experiment = load_experiment(folder)
    assert [r.use for r in experiment.records] == ["fit", "check"]
    assert experiment.channels["device.position"].unit == "mm"
    total = sum(len(r.time) for r in experiment.records)
    assert 2390 <= total <= 2400


def test_spans_that_are_stated_are_the_records(log, tmp_path):
    folder = make(log, tmp_path / "rod", spans=((2.0, 7.0), (8.0, 11.5)))
    fit, check = written(folder)["records"]
    assert fit["span"] == [2.0, 7.0] and check["span"] == [8.0, 11.5]
    with pytest.raises(ExperimentError, match="expected spans that do not overlap"):
        make(log, tmp_path / "other", spans=((2.0, 7.0), (6.0, 11.5)))
    assert not (tmp_path / "other").exists()


def test_of_several_logs_the_last_is_the_check_record(log, tmp_path):
    more = [write_log(tmp_path / f"run{k}.csv", 1.0 + 0.1 * k) for k in (1, 2)]
    folder = make(log, tmp_path / "rod", *more)
    assert written(folder)["records"] == [
        {"file": "run.csv", "use": "fit"},
        {"file": "run1.csv", "use": "fit"},
        {"file": "run2.csv", "use": "check"},
    ]
    assert sorted(p.name for p in folder.iterdir()) == [
        *("experiment.toml", "run.csv", "run1.csv", "run2.csv")
    ]
    assert written(folder)["model"]["device"]["inertia"]["value"] == pytest.approx(M, rel=0.05)


def test_an_inertia_that_is_known_is_kept_and_no_start_is_guessed(log, tmp_path):
    folder = make(log, tmp_path / "rod", inertia=0.45, effects=("coulomb", "stribeck"))
    device = written(folder)["model"]["device"]
    assert device["inertia"] == {"value": 0.45, "unit": "kg", "fixed": True}
    assert device["effects"] == {"coulomb": {}, "stribeck": {}}
    assert "model.device.inertia" not in written(folder).get("guessed", {})


def test_a_folder_that_holds_an_experiment_is_left_unless_it_may_be_replaced(log, tmp_path):
    folder = make(log, tmp_path / "rod")
    before = (folder / "experiment.toml").read_text()
    with pytest.raises(ExperimentError, match="rod/experiment.toml: is there already"):
        make(log, folder, inertia=3.0)
    assert (folder / "experiment.toml").read_text() == before
    make(log, folder, inertia=3.0, overwrite=True)
    assert written(folder)["model"]["device"]["inertia"]["value"] == 3.0


def test_a_log_in_the_folder_itself_is_left_as_it_is(log, tmp_path):
    content = log.read_bytes()
    folder = make(log, tmp_path)
    assert (folder / "run.csv").read_bytes() == content
    assert load_experiment(folder).records


def test_a_log_of_several_tables_is_copied_as_a_folder(tmp_path):
    whole = write_log(tmp_path / "whole.csv")
    lines = [line.split(",") for line in whole.read_text().splitlines()]
    parts = tmp_path / "parts"
    parts.mkdir()
    for name, columns in {"motion.csv": (0, 1), "drive.csv": (0, 2)}.items():
        (parts / name).write_text("\n".join(",".join(r[c] for c in columns) for r in lines))
    folder = make(parts, tmp_path / "rod")
    assert sorted(p.name for p in (folder / "parts").iterdir()) == ["drive.csv", "motion.csv"]
    assert len(load_experiment(folder).fit_records[0].time) > 1200


def test_a_folder_that_cannot_be_written_is_named(log, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ExperimentError, match="^rod: cannot be written: Not a directory"):
        make(log, tmp_path / "file" / "rod")


def test_signs_that_make_no_inertia_ask_to_be_looked_at(log, tmp_path):
    survey = survey_of(log)
    assert "sign" not in survey.channels["actuator_force"]
    survey.channels["actuator_force"]["sign"] = -1
    folder = make_folder(survey, [log], tmp_path / "rod", title="t")
    content = written(folder)
    assert content["guessed"]["model.device.inertia"].startswith("the motion tells no inertia")
    assert content["model"]["device"]["inertia"]["value"] == 1.0
    # neither friction nor damping starts below zero
    assert content["model"]["device"]["effects"] == {"coulomb": {}, "viscous": {}}


@pytest.mark.parametrize(("rows", "cut"), [(2400, 0.6), (150, 0.5), (127, None)])
def test_a_log_is_cut_only_where_both_parts_are_long_enough(rows, cut, tmp_path):
    """Of 153 rows at 10 Hz, 61 were left for the check record: too few, so nothing was written."""
    log = write_log(tmp_path / "short.csv")
    lines = log.read_text().splitlines()
    step = len(lines) // rows
    log.write_text("\n".join([lines[0], *lines[1::step][:rows]]) + "\n")
    survey = survey_of(log)
    records = written(make_folder(survey, [log], tmp_path / "made", title="short"))["records"]
    assert [r["use"] for r in records] == (["fit", "check"] if cut else ["fit"])
    if cut:
        assert records[0]["span"][1] == pytest.approx(cut * survey.duration, rel=1e-3)
    assert any("too short to be cut" in note for note in survey.notes) == (cut is None)
    assert load_experiment(tmp_path / "made").fit_records


@pytest.mark.parametrize("dither", [0.0, 0.01])
def test_a_log_is_not_cut_where_the_body_rests_in_a_part(dither, tmp_path):
    """A servo that reached its place after half of a log: any friction agrees with the rest."""
    t = 0.01 * np.arange(600)
    angle = np.where(t < 3.0, np.sin(2.0 * np.pi * t), 0.0) + dither * (np.arange(600) % 7 == 0)
    rows = np.column_stack([t, np.round(angle, 2), np.where(t < 3.0, np.cos(6.0 * t), 0.1)])
    log = tmp_path / "arrived.csv"
    np.savetxt(log, rows, delimiter=",", header="t_s,angle_rad,torque_Nm", comments="")
    survey = survey_of(log)
    records = written(make_folder(survey, [log], tmp_path / "made", title="arrived"))["records"]
    assert [r["use"] for r in records] == ["fit"]
    assert any("the body rests from 3.594 to 5.99 s" in note for note in survey.notes)


@pytest.mark.parametrize(("sweeps", "uses"), [(1, ["fit"]), (4, ["fit", "check"])])
def test_a_log_is_not_cut_where_a_part_runs_one_way(sweeps, uses, tmp_path):
    """Of one sweep forth and back, the check record was a part of the way back."""
    t = 0.01 * np.arange(2400)
    phase = np.mod(sweeps * t / t[-1], 1.0)
    angle = 3.0 * np.minimum(2.0 * phase, 2.0 - 2.0 * phase)
    torque = 0.1 * np.sign(np.gradient(angle)) + 0.05 * np.sin(2.0 * angle)
    log = tmp_path / "sweep.csv"
    rows = np.column_stack([t, np.round(angle, 4), torque])
    np.savetxt(log, rows, delimiter=",", header="t_s,angle_rad,torque_Nm", comments="")
    survey = survey_of(log)
    records = written(make_folder(survey, [log], tmp_path / "made", title="sweep"))["records"]
    assert [r["use"] for r in records] == uses
    assert any("the body moves one way from" in note for note in survey.notes) == (sweeps == 1)


@pytest.mark.parametrize(("lengths", "uses"), [((1.3, 0.4, 0.5), 1), ((1.3, 0.4, 1.2), 2)])
def test_pauses_and_short_trials_do_not_make_a_part_long_enough(lengths, uses, tmp_path):
    """Of three trials in 4 s, the check record held 0.97 s: it was written, and then refused."""
    tables, begin = [], 0.0
    for trial, length in enumerate(lengths):
        t = 0.005 * np.arange(round(length / 0.005))
        q, u = np.sin(5.0 * t), np.cos(5.0 * t) + 0.2 * np.sign(np.cos(5.0 * t))
        tables.append(np.column_stack([np.full(len(t), trial), begin + t, q, u]))
        begin += length + 1.0
    log = tmp_path / "trials.csv"
    names = "trial,t_s,angle_rad,torque_Nm"
    np.savetxt(log, np.vstack(tables), delimiter=",", header=names, comments="", fmt="%.7g")
    folder = make_folder(survey_of(log), [log], tmp_path / "made", title="trials")
    assert len(written(folder)["records"]) == uses
    assert load_experiment(folder).fit_records

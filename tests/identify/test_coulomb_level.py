"""The Coulomb level from runs at constant speed, on made records and on real ones."""

import shutil

import numpy as np
import pytest
from identify.runs import BIAS, DAMPING, LEVEL, write
from shared_data import shared_folder

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.identify import coulomb_level, steady_runs

SPEEDS = (0.02, 0.04, 0.08)


@pytest.fixture(scope="module")
def levels(tmp_path_factory):
    folder = write(tmp_path_factory.mktemp("runs") / "three", SPEEDS)
    return coulomb_level(td.load_experiment(folder))


def test_every_run_is_detected_once_and_nothing_else(levels):
    assert [round(r.velocity, 3) for r in levels.runs] == [s * w for s in SPEEDS for w in (1, -1)]
    # a run of 0.08 m less its ends
    for run in levels.runs:
        assert 0.6 * 0.08 < np.ptp(run.position) <= 0.08
        assert np.ptp(np.diff(run.time)) < 1e-9


def test_level_and_damping_are_within_three_standard_errors(levels):
    level, error = levels.level
    assert abs(level - LEVEL) < 3 * error
    assert abs(levels.line.damping - DAMPING) < 3 * levels.line.damping_error
    # and these are of use
    assert error < 0.05 * LEVEL


def test_gravity_cancels_and_is_reported(levels):
    for one in levels.speeds:
        assert abs(one.middle - BIAS) < 4 * one.middle_error
    assert levels.forward.level == pytest.approx(LEVEL + BIAS, abs=4 * levels.forward.level_error)
    assert levels.backward.level == pytest.approx(LEVEL - BIAS, abs=4 * levels.backward.level_error)


def test_a_spring_cancels_where_both_runs_cover_the_same_travel(tmp_path):
    """Forces of the position alone fall out of half the difference, here 2 N over the travel."""
    folder = write(tmp_path / "spring", SPEEDS, spring=25.0, size=1e-4)
    level, _ = coulomb_level(td.load_experiment(folder)).level
    # rows of both runs do not lie at the very same positions: a step of 80 um on 25 N/m
    assert level == pytest.approx(LEVEL, abs=0.005)


def test_runs_are_compared_where_both_were_however_far_one_of_them_went(tmp_path):
    """The way back is half as long: over all of both the spring would make 0.25 N of the level."""
    folder = write(tmp_path / "spring", SPEEDS[:2], spring=25.0, size=1e-4, back=0.5)
    result = coulomb_level(td.load_experiment(folder))
    assert [s.friction for s in result.speeds] == pytest.approx(
        [LEVEL + DAMPING * v for v in SPEEDS[:2]], abs=0.01
    )


def test_runs_one_way_give_a_line_but_no_level(tmp_path):
    folder = write(tmp_path / "one_way", SPEEDS)
    path = folder / "fit.csv"
    rows = path.read_text().splitlines()
    time, x, u = np.loadtxt(rows[1:], delimiter=",").T
    forward = np.gradient(np.convolve(x, np.ones(50) / 50, "same")) > -1e-6
    label = np.cumsum(np.r_[0, np.diff(forward.astype(int)) != 0])
    table = np.column_stack([time, x, u, label])[forward]
    np.savetxt(path, table, delimiter=",", header="t,x,u,s", comments="", fmt="%.9g")
    toml = (folder / "experiment.toml").read_text()
    segment = '[channels]\nsegment = { column = "s" }'
    (folder / "experiment.toml").write_text(toml.replace("[channels]", segment))
    one_way = coulomb_level(td.load_experiment(folder))
    assert one_way.level is None and one_way.backward is None
    assert one_way.forward.level == pytest.approx(LEVEL + BIAS, abs=0.05)
    assert "no Coulomb level" in repr(one_way)


def test_a_record_without_steady_motion_says_so():
    with pytest.raises(ExperimentError, match="coulomb_level: no run of 2 s at a speed within 5 %"):
        coulomb_level(td.load_experiment(td.example("rod")), shortest=2.0)


def test_recorded_positioning_system_agrees_with_its_diagnosis():
    """EMPS, 24 runs at one speed and its like: diagnosis 19.99 +- 0.17 N, 208.5 +- 2 N s/m."""
    levels = coulomb_level(td.load_experiment(shared_folder("data") / "emps"))
    level, error = levels.level
    assert abs(level - 19.99) < 3 * np.hypot(error, 0.17)
    damping = (levels.forward.damping + levels.backward.damping) / 2
    assert damping == pytest.approx(208.5, rel=0.1)
    (speed,) = levels.speeds
    # half the difference at one speed: level and damping together, to a few percent
    assert speed.friction == pytest.approx(19.99 + 208.5 * speed.speed, rel=0.05)


def test_recorded_insertion_axis_runs_at_its_commanded_speeds(tmp_path):
    """PSM: outward at 15 speeds from 0.01 to 0.15 m/s, quick returns at about 0.097 m/s."""
    source = shared_folder("data") / "psm_insertion"
    for name in ("psm1_constant_speed_out.csv.gz", "psm1_fourier1.csv.gz"):
        shutil.copy(source / name, tmp_path / name)
    toml = (source / "experiment.toml").read_text()
    head, _, _ = toml.partition("[[records]]")
    record = '[[records]]\nfile = "psm1_constant_speed_out.csv.gz"\nuse = "fit"\n'
    (tmp_path / "experiment.toml").write_text(head + record)
    experiment = td.load_experiment(tmp_path)
    out = {round(r.velocity, 2) for r in steady_runs(experiment) if r.direction > 0}
    assert out == {round(0.01 * k, 2) for k in range(1, 16)}
    levels = coulomb_level(experiment)
    (both,) = levels.speeds
    # the diagnosis of the Fourier paths of another day: 0.40 to 0.81 N along the travel, 1.6 N s/m
    assert both.speed == pytest.approx(0.097, abs=0.002)
    assert 0.5 < both.friction < 0.8

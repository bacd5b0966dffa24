"""Numbers of the readers and their tools against closed formulas, and limits from both sides."""

import datetime

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._cells import numbers_of
from teleopdesign.measurement.saving import content_digest, experiment_files

# columns


@pytest.mark.parametrize("delay", [0.2, -0.2])
def test_a_delay_of_a_fifth_of_a_second_is_taken_off(delay):
    t = np.arange(4000) / 200.0
    late = np.sin(t - delay)
    position = {"column": "x", "unit": "rad", "delay": {"value": 1e3 * delay, "unit": "ms"}}
    force = {"column": "y", "unit": "N*m"}
    made = td.experiment(
        {"t": t, "x": late, "y": late},
        axis="revolute",
        inertia=1.0,
        position=position,
        actuator_force=force,
    )
    inner = slice(60, -60)
    signal = made.records[0].signals["device.position"]
    assert signal[inner] == pytest.approx(np.sin(t)[inner], abs=1e-6)


MINUTE = datetime.datetime(2026, 1, 1, 12, 0)
CELLS = [
    (np.array([[1.0], [2.0]]), [1.0, 2.0]),
    (np.array([[1, 2, 3]]), [1.0, 2.0, 3.0]),
    (np.array([True, False]), [1.0, 0.0]),
    (np.array([None, 2], dtype=object), [np.nan, 2.0]),
    (np.array(["1.5", 2], dtype=object), [1.5, 2.0]),
    (np.array([2**53, 2**53 + 2]), [float(2**53), float(2**53 + 2)]),
    # above, numbers count from the first
    (np.array([2**53 + 1, 2**53 + 3]), [0.0, 2.0]),
    (np.array([-(2**60), 5 - 2**60]), [0.0, 5.0]),
    (np.array(["2026-01-01T12", "NaT", "2026-01-01T13"], "datetime64[m]"), [0.0, np.nan, 3600.0]),
    (np.array([500, 1500], "timedelta64[ms]"), [0.0, 1.0]),
    (np.array([MINUTE, MINUTE + datetime.timedelta(seconds=2)], dtype=object), [0.0, 2.0]),
]


@pytest.mark.parametrize(("cells", "numbers"), CELLS, ids=lambda v: str(v)[:30])
def test_cells_are_numbers_or_seconds(cells, numbers):
    out = numbers_of(cells, "x", "log.csv")
    assert out.dtype == np.float64
    np.testing.assert_array_equal(out, numbers)


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        (np.zeros((2, 2)), r"log.csv: channels.position: column \"x\": found an array of shape"),
        (np.array([1, "a"], dtype=object), r"column \"x\", row 2: found \"a\", expected a number"),
        (np.array([1j, 2j]), "row 1: found"),
    ],
)
def test_cells_that_are_no_numbers_are_named_with_their_row(cells, words):
    with pytest.raises(ExperimentError, match=words):
        numbers_of(cells, "x", "log.csv", "channels.position")


# files


def test_the_digest_of_an_experiment_is_that_of_the_files_that_it_names(tmp_path):
    (tmp_path / "experiment.toml").write_text('[[records]]\nfile = "a.csv"\n')
    (tmp_path / "a.csv").write_text("1")
    (tmp_path / "b.csv").write_text("1")
    assert list(experiment_files(tmp_path)) == ["experiment.toml", "a.csv"]
    first = content_digest(tmp_path)
    (tmp_path / "b.csv").write_text("2")
    assert content_digest(tmp_path) == first
    (tmp_path / "a.csv").write_text("2")
    second = content_digest(tmp_path)
    (tmp_path / "a.csv").unlink()
    (outside := tmp_path.parent / "outside.csv").write_text("2")
    third = content_digest(tmp_path)
    (tmp_path / "a.csv").symlink_to(outside)
    assert experiment_files(tmp_path)["a.csv"] is None, "a link that leads out of the folder"
    assert len({first, second, third}) == 3 and content_digest(tmp_path) == third


def test_the_files_of_a_bag_count_one_by_one(tmp_path):
    (tmp_path / "experiment.toml").write_text('[[records]]\nfile = "bag"\n')
    (tmp_path / "bag" / "deep").mkdir(parents=True)
    (tmp_path / "bag" / "deep" / "x.db3").write_text("1")
    (tmp_path / "bag" / "metadata.yaml").write_text("1")
    names = ["experiment.toml", "bag/deep", "bag/deep/x.db3", "bag/metadata.yaml"]
    assert list(experiment_files(tmp_path)) == names
    (tmp_path / "experiment.toml").write_text("[[records]\n")
    assert list(experiment_files(tmp_path)) == ["experiment.toml"]


# how short a record may be, and how uneven


def read(t, **more):
    table = {"t": t, "x": np.sin(t), "y": np.cos(t)}
    return td.experiment(
        table, axis="revolute", position="x", actuator_force="y", inertia=1.0, **more
    ).records[0]


def test_sixty_four_rows_of_a_second_are_a_record():
    assert len(read(np.arange(64) / 64.0).time) == 64
    with pytest.raises(ExperimentError, match="found 63 rows, expected at least 64"):
        read(np.arange(63) / 50.0)
    with pytest.raises(ExperimentError, match=r"found 0.985 s of samples, expected at least 1 s"):
        read(np.arange(64) / 65.0)


@pytest.mark.parametrize(("lost", "stretches"), [(5, 1), (6, 2)])
def test_five_lost_rows_are_filled_and_six_are_a_pause(lost, stretches):
    t = np.delete(np.arange(300) / 100.0, np.arange(100, 100 + lost))
    record = read(t)
    assert len(record.segments) == stretches
    assert len(record.time) == (300 if stretches == 1 else 300 - lost)

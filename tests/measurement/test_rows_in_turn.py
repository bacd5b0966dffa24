"""Tables whose rows belong to several machines in turn, with and without a column that says so."""

import itertools
import json

import numpy as np
import pytest

from teleopdesign.measurement import tables
from teleopdesign.measurement.doors._in_turn import MOST_MACHINES, parts_by_time, turns_of
from teleopdesign.measurement.survey import Choices, survey_log

STEP, ROWS = 0.005, 800
T = STEP * np.arange(ROWS)


def machine(k):
    """Time, position and torque of a motor with friction, which differ for each k."""
    q = 2.0 * k + np.sin(2 * np.pi * (0.7 + 0.3 * k) * T) + 0.3 * np.sin(9.0 * T)
    rate = np.gradient(q, T)
    torque = 0.01 * np.gradient(rate, T) + 0.2 * np.tanh(rate / 0.05)
    return np.column_stack([T + 0.07 * k, q, torque])


def write(path, header, rows, separator=","):
    lines = (separator.join(map(str, row)) for row in rows)
    path.write_text("\n".join([separator.join(header), *lines]) + "\n")
    return tables.open_log(path, path.name)


def in_turn(labels, batch=1):
    """Rows (label, time, position, torque), `batch` rows of each machine at a time."""
    sources = [machine(k) for k in range(len(labels))]
    for begin in range(0, ROWS, batch):
        for label, source in zip(labels, sources, strict=True):
            for row in source[begin : begin + batch]:
                yield (label, *(round(float(x), 6) for x in row))


@pytest.mark.parametrize(
    ("header", "labels", "batch"),
    [
        (("motor_id", "t", "pos", "cmd"), ("1", "2", "3"), 1),
        (("joint_name", "time", "position", "effort"), ("hip", "knee"), 1),
        (("joint_name", "time", "position", "effort"), ("hip", "knee"), 100),
        (("id", "time_s", "angle", "torque"), ("7", "12"), 40),
    ],
)
def test_each_machine_of_a_table_is_read_apart(tmp_path, header, labels, batch):
    """The position leapt from one motor to the other: such a log was read as one body."""
    log = write(tmp_path / "log.csv", header, in_turn(labels, batch), ";")
    assert f"rows of {len(labels)} machines in turn" in " ".join(log.notes)
    for k, label in enumerate(labels):
        names = [f"{label}.{name}" for name in header[1:]]
        read = log.read(dict.fromkeys(names, ""))
        for name, column in zip(names, machine(k).T, strict=True):
            np.testing.assert_allclose(read[name], column, atol=1e-6)
    result = survey_log(log, "log", Choices(position=f"{labels[1]}.{header[2]}"))
    assert result.channels["actuator_force"]["column"] == f"{labels[1]}.{header[3]}"
    assert result.channels["time"]["column"] == f"{labels[1]}.{header[1]}"


def test_batches_of_two_machines_are_separated_by_their_times(tmp_path):
    """The time was set back at each batch: each was a segment of the same body."""
    rows = [row[1:] for row in in_turn("ab", 100)]
    log = write(tmp_path / "log.csv", ("pi_time", "position", "torque"), rows)
    assert "told apart by their times" in log.notes[-1]
    read = log.read({"part 2.position": "", "part 2.pi_time": "", "part 1.torque": ""})
    np.testing.assert_allclose(read["part 2.position"], machine(1)[:, 1], atol=1e-6)
    np.testing.assert_allclose(read["part 2.pi_time"], machine(1)[:, 0], atol=1e-6)
    np.testing.assert_allclose(read["part 1.torque"], machine(0)[:, 2], atol=1e-6)


def one_machine():
    return [tuple(round(float(x), 6) for x in row) for row in machine(0)]


@pytest.mark.parametrize(
    ("header", "rows"),
    [
        pytest.param(
            ("direction", "time", "position", "torque"),
            [("FWD" if row[2] > 0 else "REV", *row) for row in one_machine()],
            id="the direction of a motion",
        ),
        pytest.param(
            ("trial", "time", "position", "torque"),
            [(k, *row) for k in "ab" for row in one_machine()],
            id="two trials",
        ),
        pytest.param(
            ("motor", "time", "position", "torque"),
            [(k % 2, *row) for k, row in enumerate(one_machine())],
            id="a bit that toggles",
        ),
        pytest.param(
            ("pwm", "time", "position", "torque"),
            [(255 * (k % 2), *row[:2], row[2] * (-1) ** k) for k, row in enumerate(one_machine())],
            id="a command that toggles",
        ),
        pytest.param(
            ("time", "position", "torque"),
            [*one_machine()[:300], *one_machine()[:250], *one_machine()[100:500]],
            id="a clock that is set back twice",
        ),
    ],
)
def test_one_machine_stays_one_machine(tmp_path, header, rows):
    log = write(tmp_path / "log.csv", header, rows)
    assert log.names == header and not log.clocks


def test_a_table_without_time_or_with_few_rows_is_one_machine():
    rows = [[str(x) for x in row] for row in itertools.islice(in_turn("ab"), 60)]
    assert turns_of(("id", "t", "pos", "cmd"), rows, False).names == ("a", "b")
    assert turns_of(("id", "a", "pos", "cmd"), rows, False) is None
    assert turns_of(("id", "t", "pos", "cmd"), rows[:15], False) is None
    assert turns_of(("id", "t", "pos", "cmd"), [[r[0], "", *r[2:]] for r in rows], False) is None


def test_a_time_that_always_falls_has_no_parts_without_end():
    parts, returns = parts_by_time(-np.arange(1000.0))
    assert returns == 0 and int(parts.max()) <= MOST_MACHINES + 1
    assert parts_by_time(np.zeros(3))[1] == 0


def as_json(path, records):
    path.write_text(json.dumps(records))


def as_parquet(path, records):
    pytest.importorskip("pyarrow")
    pytest.importorskip("pandas").DataFrame(records).to_parquet(path)


@pytest.mark.parametrize(("kind", "write_records"), [("json", as_json), ("parquet", as_parquet)])
@pytest.mark.parametrize("labels", [("hip", "knee"), (3, 8)])
def test_records_of_several_machines_are_read_apart(tmp_path, kind, write_records, labels):
    names = "joint", "time", "position", "effort"
    records = [dict(zip(names, row, strict=True)) for row in in_turn(labels)]
    write_records(tmp_path / f"log.{kind}", records)
    log = tables.open_log(tmp_path / f"log.{kind}", "log")
    one, other = labels
    read = log.read({f"{one}.effort": "", f"{other}.time": ""})
    np.testing.assert_allclose(read[f"{one}.effort"].astype(float), machine(0)[:, 2], atol=1e-6)
    np.testing.assert_allclose(read[f"{other}.time"], machine(1)[:, 0], atol=1e-6)


def test_records_of_one_machine_stay_as_they_are(tmp_path):
    for names in (("joint", "time", "x", "u"), ("id", "a", "x", "u"), ("state", "time", "x", "u")):
        records = [dict(zip(names, ("hip", *row), strict=True)) for row in one_machine()]
        as_json(tmp_path / "log.json", records)
        assert set(tables.open_log(tmp_path / "log.json", "log").names) == set(names)


def test_dates_of_several_machines_are_seconds(tmp_path):
    rows = [(k, f"2024-03-09 19:03:{10 + t:09.6f}", q, u) for k, t, q, u in in_turn("ab")]
    log = write(tmp_path / "log.csv", ("joint", "time", "position", "torque"), rows)
    time = log.read({"b.time": ""})["b.time"]
    np.testing.assert_allclose(time - time[0], machine(1)[:, 0] - machine(1)[0, 0], atol=1e-6)

"""Tables with a time before each signal."""

import numpy as np
import openpyxl
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log, read_columns

T = np.arange(3000)
Q = np.round(400 * np.sin(2 * np.pi * 0.4e-3 * T) + 120 * np.sin(2 * np.pi * 1.7e-3 * T)) + 900
V = np.gradient(Q)
U = np.round(30 * np.gradient(np.convolve(V, np.ones(40) / 40, "same")) + 25 * np.sign(V), 2)
SIGNALS = {"Position actual value [0x6064]": Q, "Torque actual value [0x6077]": U}


def write_columns(path, names, columns):
    rows = [",".join(names[k : k + len(columns)]) for k in range(0, len(names), len(columns))]
    longest = max(map(len, columns))
    cells = [[f"{v:g}" for v in c] + [""] * (longest - len(c)) for c in columns]
    path.write_text("\n".join([*rows, *(",".join(row) for row in zip(*cells, strict=True))]) + "\n")
    return path


def titles_and_letters():
    titles = [cell for name in SIGNALS for cell in (name, "")]
    return [*titles, "X", "Y", "X", "Y"]


def channels_of(path, **choices):
    log = open_log(path, path.name)
    channels = survey_log(log, path.name, Choices(**choices)).channels
    return log, {quantity: table.get("column") for quantity, table in channels.items()}


def test_the_same_times_before_each_signal_are_one_time(tmp_path):
    path = write_columns(tmp_path / "drive.csv", titles_and_letters(), [T, Q, T, U])
    log, channels = channels_of(path, axis="revolute")
    assert log.names == ("time", *SIGNALS) and not log.clocks
    position, torque = SIGNALS
    assert channels == {"time": "time", "position": position, "actuator_force": torque}
    read = log.read(dict.fromkeys(log.names, ""))
    assert np.array_equal(read[position], Q) and np.array_equal(read[torque], U)


@pytest.mark.parametrize("header", ["letters", "time"])
def test_times_that_differ_are_clocks_of_their_signals(tmp_path, header):
    """The torque at half the rate of the position, so that its columns end halfway."""
    names = titles_and_letters() if header == "letters" else ["time (ms)", "q", "time (ms)", "tau"]
    path = write_columns(tmp_path / "drive.csv", names, [T, Q, T[::2] + 1, U[1::2]])
    log, channels = channels_of(path, axis="revolute")
    position, torque = SIGNALS if header == "letters" else ("q", "tau")
    clock = f"time of {position}"
    assert channels == {"time": clock, "position": position, "actuator_force": torque}
    wanted = {
        clock: "channels.time",
        position: "channels.position",
        torque: "channels.actuator_force",
    }
    columns = read_columns(path, path.name, wanted)
    assert columns.values[clock] == pytest.approx(T / 1000)
    assert np.array_equal(columns.values[position], Q)
    assert np.array_equal(columns.values[torque], U[1::2])
    assert columns.stamps[torque] == pytest.approx((T[::2] + 1) / 1000)
    assert any("times of their own" in note for note in log.notes)


def test_times_without_a_unit_have_that_of_the_slowest_clock(tmp_path):
    """Steps of 0.125 alone would be seconds; beside steps of 1 they are 0.125 ms."""
    path = write_columns(
        tmp_path / "drive.csv", titles_and_letters(), [T[:300], Q[:300], T * 0.125, U]
    )
    log = open_log(path, path.name)
    position, torque = SIGNALS
    read = log.read({f"time of {torque}": "", f"time of {position}": ""})
    assert read[f"time of {torque}"][-1] == pytest.approx(0.125e-3 * (len(T) - 1))
    assert read[f"time of {position}"][-1] == pytest.approx(0.299)


def test_clocks_that_do_not_run_together_stay_columns(tmp_path):
    names = ["time (ms)", "q", "time (ms)", "tau"]
    path = write_columns(tmp_path / "log.csv", names, [T, Q, T + 1e6, U])
    assert open_log(path, path.name).names == ("time (ms) #1", "q", "time (ms) #2", "tau")


@pytest.mark.parametrize("kind", ["places", "rising readings", "one signal", "names"])
def test_other_tables_stay_as_they_are(tmp_path, kind):
    place = T + 3 * np.sin(T / 50.0) + 0.4 * np.sin(T * 1.3)
    names, columns = titles_and_letters(), [T, Q, T, U]
    if kind == "places":  # of a body that a camera sees move to the right
        columns = [place, Q, place, U]
    elif kind == "rising readings":
        columns = [T, T + 1.0, T, 2.0 * T]
    elif kind == "one signal":
        names, columns = ["time", "q"], [T, Q]
    else:
        names = ["time", "q", "count", "tau"]
    log = open_log(write_columns(tmp_path / "log.csv", names, columns), "log.csv")
    assert len(log.names) == len(columns) and not log.clocks


@pytest.mark.parametrize("rate", ["same", "half"])
def test_a_workbook_with_a_time_before_each_signal_is_read_in_the_same_way(tmp_path, rate):
    book = openpyxl.Workbook()
    titles = ["Torque", None, "Position", None]
    columns = [T, U, T, Q] if rate == "same" else [T[::2], U[::2], T, Q]
    for row in (titles, ["X", "Y", "X", "Y"]):
        book.active.append(row)
    for k in range(len(T)):
        book.active.append([float(c[k]) if k < len(c) else None for c in columns])
    book.save(tmp_path / "log.xlsx")
    log, channels = channels_of(tmp_path / "log.xlsx", axis="revolute")
    assert channels["position"] == "Position" and channels["actuator_force"] == "Torque"
    assert channels["time"] == ("time" if rate == "same" else "time of Position")
    assert len(log.read({"Torque": ""})["Torque"]) == len(columns[1])


def test_clocks_of_signals_that_are_no_numbers_are_refused_with_the_reason(tmp_path):
    path = write_columns(tmp_path / "log.csv", titles_and_letters(), [T, Q, T + 1, U])
    lines = path.read_text().splitlines()
    lines[12] = "10,nan10,11,nan10"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(ExperimentError, match='found no column of numbers.*found "nan10"'):
        channels_of(path)

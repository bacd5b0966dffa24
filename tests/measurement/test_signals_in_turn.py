"""Traces of controllers: a signal after the other, each with its times."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log

T = np.arange(3000)
Q = np.round(400 * np.sin(2 * np.pi * 0.4e-3 * T) + 120 * np.sin(2 * np.pi * 1.7e-3 * T))
V = np.gradient(Q)
U = np.round(30 * np.gradient(np.convolve(V, np.ones(40) / 40, "same")) + 25 * np.sign(V), 2)


def channels_of(path):
    log = open_log(path, path.name)
    channels = survey_log(log, path.name, Choices(axis="revolute")).channels
    return log, {quantity: table.get("column") for quantity, table in channels.items()}


def write_trace(path, signals):
    lines = ["[key]; [value]", "Version; 0x03050000", "Trigger.Flags; 0", "BufferEntries; 101"]
    for k, (name, times, values) in enumerate(signals):
        lines += [f"{k}.Variable; {name}", f"{k}.Class; 14", f"{k}.YAxis; 0", f"{k}.Data; "]
        lines += [f"; {t}; {v}" for t, v in zip(times, values, strict=True)]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_a_trace_with_a_signal_after_the_other_is_a_table(tmp_path):
    state = np.where(T < 1000, "FALSE", "TRUE")
    signals = [("Axis.Enabled", T, state), ("Axis.ActPos", T, Q), ("Axis.ActTorque", T, U)]
    path = write_trace(tmp_path / "trace.csv", signals)
    log, channels = channels_of(path)
    assert log.names == ("time", "Axis.Enabled", "Axis.ActPos", "Axis.ActTorque")
    expected = {"time": "time", "position": "Axis.ActPos", "actuator_force": "Axis.ActTorque"}
    assert channels == expected
    read = log.read(dict.fromkeys(log.names, ""))
    assert np.array_equal(read["Axis.ActPos"], Q) and np.array_equal(read["Axis.ActTorque"], U)
    assert np.array_equal(read["Axis.Enabled"], T >= 1000)


def test_signals_of_a_trace_have_a_clock_each_where_they_differ(tmp_path):
    signals = [("Axis.ActPos", T, Q), ("Axis.ActTorque", T[::4], U[::4])]
    log, channels = channels_of(write_trace(tmp_path / "trace.csv", signals))
    assert channels["time"] == "time of Axis.ActPos"
    assert len(log.read({"Axis.ActTorque": ""})["Axis.ActTorque"]) == len(T[::4])


@pytest.mark.parametrize("row", ["; 7", "; a; 7", "; 1; 2; 3"])
def test_a_row_of_a_trace_that_is_no_row_is_named(tmp_path, row):
    path = write_trace(tmp_path / "trace.csv", [("q", T, Q)])
    path.write_text(path.read_text() + row + "\n")
    with pytest.raises(ExperimentError, match="expected a time and a reading"):
        open_log(path, "trace.csv")


def test_a_trace_without_rows_says_so(tmp_path):
    path = write_trace(tmp_path / "trace.csv", [("q", [], []), ("tau", [], [])])
    with pytest.raises(ExperimentError, match="signals without rows"):
        open_log(path, "trace.csv")


@pytest.mark.parametrize("stamps", [[5.0], [], ["nan"] * 4, ["inf"] * 4])
def test_a_signal_of_a_trace_without_two_times_is_left_out(tmp_path, stamps):
    gain = ("Axis.Gain", stamps, [3.0] * len(stamps))
    signals = [gain, ("Axis.ActPos", T, Q), ("Axis.ActTorque", T, U)]
    log, channels = channels_of(write_trace(tmp_path / "trace.csv", signals))
    assert channels["position"] == "Axis.ActPos" and "Axis.Gain" not in log.names
    assert bool(stamps) == any("left out: Axis.Gain" in note for note in log.notes)

"""Logs as benches leave them: serial dumps, headers of blocks, structs of signals, field buses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from teleopdesign.base.errors import ExperimentError
from teleopdesign.cli import main
from teleopdesign.measurement.column_names import likeness, words_of
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log, read_columns

ROWS = 1200
T = 0.005 * np.arange(ROWS)
Q = np.sin(2 * np.pi * 0.7 * T) + 0.2 * np.sin(2 * np.pi * 2.1 * T)
U = 0.02 * np.gradient(np.gradient(Q, T), T) + 0.3 * np.sign(np.gradient(Q, T))


def write(path, lines, encoding="utf-8"):
    path.write_bytes(("\n".join(lines) + "\n").encode(encoding))
    return path


def rows(form, *columns):
    return [form % row for row in zip(*(c.tolist() for c in columns), strict=True)]


def look(columns, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices(**choices))


BOOT = ["ets Jul 29 2019", "rst:0x1 (POWERON_RESET)", "millis,enc,i"]


def serial_dump(at, garbled=()):
    """A dump of a microcontroller that is garbled at first and starts anew before row `at`."""
    table = rows("%d,%d,%.4g", 5 * np.arange(ROWS), np.round(1000 * Q), U)
    return ["x\xfe2,4", "3,-7", *BOOT, *table[:at], *garbled, *BOOT, *table[at:]]


@pytest.mark.slow
@given(at=st.integers(3, ROWS), seed=st.integers(0, 99))
def test_messages_of_a_logger_among_the_rows_are_left_out_and_counted(tmp_path_factory, at, seed):
    garbled = [[], ["12"], ["1200,3"], ["ready"]][seed % 4]
    path = write(tmp_path_factory.mktemp("d") / "dump.txt", serial_dump(at, garbled), "cp1252")
    columns = read_columns(path, "dump.txt", {"enc": "", "i": ""})
    assert np.array_equal(columns.values["enc"], np.round(1000 * Q))
    lines = 3 + len(garbled)
    last = at == ROWS  # the last line of the file is then a row that was cut off, or a header
    assert any(f"{n} lines that are no rows" in note for note in columns.notes
               for n in ((lines, lines - 1) if last else (lines,)))  # fmt: skip


def test_a_table_with_many_rows_of_another_form_is_refused(tmp_path):
    lines = ["a,b,c", *rows("%.4g,%.4g,%.4g", T, Q, U)]
    lines[100::50] = [f"{t:.4g},1" for t in T[99::50]]
    with pytest.raises(ExperimentError, match="row 100: found 2 cells, expected 3"):
        read_columns(write(tmp_path / "log.csv", lines), "log.csv", {"a": ""})


def test_a_header_of_blocks_gives_names_and_units(tmp_path):
    lines = [
        "LabVIEW Measurement\t", "Separator\tTab", "Decimal_Separator\t,", "***End_of_Header***\t",
        "\t", "Channels\t2\t\t", f"Samples\t{ROWS}\t{ROWS}\t", "Date\t2026/03/02\t2026/03/02\t",
        "Time\t22:14:07,1\t22:14:07,1\t", "Y_Unit_Label\tdeg\tN*m", "X0\t0,0E+0\t0,0E+0\t",
        "Delta_X\t0,005\t0,005\t", "***End_of_Header***\t\t", "X_Value\tAngle\tMotor\tComment",
    ]  # fmt: skip
    table = [row.replace(".", ",") for row in rows("%.6f\t%.6f\t%.6f", T, Q, U)]
    log = open_log(write(tmp_path / "run.lvm", [*lines, *table]), "run.lvm")
    assert log.names == ("X_Value", "Angle", "Motor")
    assert log.units == {"Angle": "deg", "Motor": "N*m"}
    assert np.allclose(log.read({"Angle": ""})["Angle"], Q, atol=1e-6)


def test_numbers_above_a_table_are_no_rows_of_it(tmp_path):
    """A motion capture writes its rate, devices in merged cells, names, and units."""
    lines = ["Devices", "250", ",,Encoder,Amplifier", "Frame,Sub Frame,Angle,Current", ",,deg,A"]
    table = rows("%d,0,%.6f,%.6f", np.arange(ROWS), Q, U)
    log = open_log(write(tmp_path / "run.csv", [*lines, *table]), "run.csv")
    assert log.names == ("Frame", "Sub Frame", "Angle", "Current")
    assert log.units == {"Angle": "deg", "Current": "A"}
    assert np.allclose(log.read({"Current": ""})["Current"], U, atol=1e-6)


@pytest.mark.parametrize("count", [1, 2])
def test_signals_of_a_struct_have_the_names_and_units_that_they_say(tmp_path, count):
    """A real-time system writes a struct a signal, with its place in the model as its name."""
    kind = [("Name", object), ("Data", object), ("Unit", object)]
    x, y = np.zeros((1, 1), dtype=kind), np.zeros((1, count), dtype=kind)
    x[0, 0] = ("Time", T[None, :], "s")
    channels = [('"Model Root"/"Encoder"/"Angle"', Q, "deg"), ('"Model Root"/"Tau cmd"', U, "Nm")]
    for k, (name, values, unit) in enumerate(channels[:count]):
        y[0, k] = (name, values[None, :], unit)
    savemat(tmp_path / "rec.mat", {"rec": {"X": x, "Y": y, "Info": {"Name": "rec"}}})
    log = open_log(tmp_path / "rec.mat", "rec.mat")
    assert log.names == ("rec.X.Time", "rec.Y.Angle", "rec.Y.Tau cmd")[: 1 + count]
    assert log.units["rec.Y.Angle"] == "deg"
    assert np.array_equal(np.ravel(log.read({"rec.Y.Angle": ""})["rec.Y.Angle"]), Q)


def test_signals_of_one_name_keep_their_whole_place(tmp_path):
    y = np.zeros((1, 2), dtype=[("label", object), ("values", object)])
    y[0, 0], y[0, 1] = ("left/q", Q), ("right/q", U)
    savemat(tmp_path / "rec.mat", {"t": T, "out": y})
    assert open_log(tmp_path / "rec.mat", "r").names == ("t", "out.left/q", "out.right/q")


def test_addresses_of_a_field_bus_are_no_words():
    assert [*words_of("0x6077:00 Torque actual value [0.1%]")] == ["torque", "actual", "value"]
    assert likeness("0x6077:00 Torque", "position") == 0.0 < likeness("x 60", "position")


def test_parts_of_a_rated_torque_are_distinguished_from_a_torque():
    table = {"t": T, "q": Q, "Target torque [0.1%]": 1000 * U}
    why = look(table).guesses["channels.actuator_force.unit"]
    assert "parts of a rated force" in why and "`scale`" in why


def test_whole_numbers_of_an_encoder_are_counts_and_a_rounded_angle_is_none():
    counts = np.round(3000 * Q)
    survey = look({"t": T, "enc": counts, "i": U}, axis="revolute")
    assert survey.channels["position"]["unit"] == "counts"
    assert "whole numbers" in survey.guesses["channels.position.unit"]
    for name, values in {"angle": counts, "enc": counts + 0.25 * np.sin(T)}.items():
        survey = look({"t": T, name: values, "i": U}, axis="revolute")
        assert survey.channels["position"]["unit"] == "deg"


def test_the_unit_of_a_motors_constant_says_the_axis():
    table = {"t": T, "a": Q, "current": U}
    for unit, axis in (("N*m/A", "revolute"), ("N/A", "prismatic")):
        survey = look(table, torque_constant=(2.0, unit))
        assert survey.axis == axis and "model.device.axis" not in survey.guesses


def test_a_velocity_in_units_says_that_a_guessed_time_is_wrong():
    """Frames of a motion capture at 200 Hz: a count of rows looks like milliseconds."""
    table = {"Frame": np.arange(ROWS), "Angle [deg]": 40 * Q, "Current [A]": U}
    speed = np.gradient(40 * Q, T)
    why = look({**table, "Velocity [deg/s]": speed}).guesses["channels.time.unit"]
    assert "requires steps of 0.005 s: --unit 'Frame=5000 us'" in why
    stated = look({**table, "Velocity [deg/s]": speed}, units={"Frame": "5000 us"})
    assert stated.duration == pytest.approx(T[-1])
    assert "channels.time.unit" not in stated.guesses
    why = look({**table, "Velocity [deg/s]": 5 * speed}).guesses["channels.time.unit"]
    assert "requires" not in why


def test_a_stated_rate_is_printed_once(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write(tmp_path / "log.csv", ["pos_deg,torque_Nm", *rows("%.6g,%.6g", 40 * Q, U)])
    assert main(["new", "log.csv", "--yes", "--sample-rate", "200"]) == 0
    (line,) = [r for r in capsys.readouterr().out.splitlines() if "sample_rate" in r]
    assert line.split() == ["sample_rate", "200", "Hz"]

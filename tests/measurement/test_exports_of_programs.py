"""Text logs as scopes, simulators, serial monitors and operating systems write them."""

import numpy as np
import pytest
from measurement.made_logs import ROWS, Q, T, U, V, columns_of, rows, survey

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._two_part_time import are_parts_of_time
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.survey.remarks import sample_rate_in
from teleopdesign.measurement.tables import open_log, read_columns

LABVIEW = [
    "LabVIEW Measurement\t", "Separator\tTab", "Multi_Headings\tYes", "***End_of_Header***\t",
    "\t", "Channels\t2\t\t",
]  # fmt: skip


def block(more, ends=""):
    """The header of a block: rows of numbers and dates under labels."""
    filled = {"Samples": "400", "Date": "2031/02/03", "Time": "10:11:12.9", **more}
    lines = [f"{label}\t{cell}\t{cell}{ends}" for label, cell in filled.items()]
    return [*lines, f"***End_of_Header***\t\t{ends}"]


def test_a_header_before_each_block_of_rows_is_left_out_whatever_their_number(tmp_path):
    table = rows("%.6f\t%.6f\t%.6f", T, Q, U)
    lines = list(LABVIEW)
    for begin in range(0, ROWS, 40):
        again = block({"X0": f"{T[begin]:.4E}", "Delta_X": "0.002"}, ends="\t")
        lines += [*again, "X_Value\tAngle (deg)\tTorque (Nm)\tComment", *table[begin : begin + 40]]
    log, proposal = survey(tmp_path, lines, "run.lvm")
    assert log.names == ("X_Value", "Angle (deg)", "Torque (Nm)")
    assert columns_of(proposal.channels)["position"] == "Angle (deg)"
    read = read_columns(tmp_path / "run.lvm", "run.lvm", {"Torque (Nm)": ""})
    assert np.array_equal(read.values["Torque (Nm)"], U)


def test_a_time_before_each_channel_stands_below_labelled_rows_of_numbers(tmp_path):
    labels = block({"Y_Unit_Label": "deg", "X0": "0", "Delta_X": "0.002"}, ends="\t")
    names = "X_Value\tEncoder\tX_Value\tMotor current\tComment"
    table = rows("%.6f\t%.6f\t%.6f\t%.6f", T, Q, T, U)
    log, proposal = survey(tmp_path, [*LABVIEW, *labels, names, *table], "run.lvm")
    assert log.names == ("time", "Encoder", "Motor current")
    assert proposal.channels["position"]["unit"] == "deg"


def test_a_table_without_times_has_the_rate_that_stands_above_it(tmp_path):
    labels = block({"X0": "0", "Delta_X": "0.002"})
    table = rows("\t%.6f\t%.6f", Q, U)
    lines = [*LABVIEW, *labels, "X_Value\tAngle (deg)\tTorque (Nm)\tComment", *table]
    _, proposal = survey(tmp_path, lines, "run.lvm")
    assert proposal.channels["sample_rate"] == {"value": 500.0, "unit": "Hz"}
    assert "Delta_X" in proposal.guesses["sample_rate"]


@pytest.mark.parametrize(
    ("line", "rate"),
    [
        ("#Sample rate: 1000Hz", 1000.0),
        ("Sampling frequency = 2.5 kHz", 2500.0),
        ("Abtastrate;200 Hz", 200.0),
        ("Sample Interval,4.0e-04,", 2500.0),
        ("Delta_X\t0,001000\t0,001000", 1000.0),
        ("SampleTime[ms];2;2", 500.0),
        ("sampling period: 500 us", 2000.0),
        ("Time(s),CH1V,t0 = -1, tInc = 1.0e-03,", 1000.0),
        ("SAMPLE RATE: 1 KHZ", 1000.0),
        ("Sampling period (US): 500", 2000.0),
        ("Sample time: 1e-320 ns", None),
        ("Sample rate: 1e308 kHz", None),
        ("Sample time: 10:11:12", None),
        ("Sample rate: unknown", None),
        ("Sample interval, 0", None),
        ("Samples,400", None),
    ],
)
def test_a_line_above_a_table_states_the_rate_of_its_rows(line, rate):
    stated = sample_rate_in(["Bench 3", line])
    assert (stated and stated[0]) == (rate and pytest.approx(rate))


@pytest.mark.parametrize("end", ["", ","])
def test_constants_beside_the_names_of_a_scope_are_no_columns(tmp_path, end):
    lines = ["X,CH1,CH2,Start,Increment,", "Sequence,VOLT,VOLT,-6.0e-01,2.0e-03"]
    table = rows(f"%d,%.3e,%.3e{end}", np.arange(ROWS), Q / 10, U)
    chosen = {"position": "CH1", "actuator_force": "CH2"}
    log, proposal = survey(tmp_path, [*lines, *table], **chosen)
    assert log.names[:3] == ("X", "CH1", "CH2") and log.units["CH2"] == "V"
    assert proposal.channels["sample_rate"]["value"] == 500.0, "X counts the rows"
    with pytest.raises(ExperimentError, match="if 'CH1' is the position: --position 'CH1'"):
        survey_log(log, "log.csv", Choices())  # X is no position either


def test_channels_that_are_called_by_their_numbers_stand_above_a_row_of_units(tmp_path):
    lines = ["x-axis,1,2", "second,Volt,Volt", *rows("%.6f,%.5f,%.5f", T, Q / 10, U)]
    log, _ = survey(tmp_path, lines, position="1", actuator_force="2")
    assert log.names == ("x-axis", "1", "2")
    assert dict(log.units) == {"x-axis": "s", "1": "V", "2": "V"}


KEYED = [
    ",Type: double,Type: double,,Type: single",
    ",Unit: deg,Unit: deg,,Unit: N*m",
    ",Interp: linear,Interp: zoh,,Interp: zoh",
    ",PortIndex: 1,PortIndex: 1,,PortIndex: 1",
]


def test_rows_whose_cells_say_what_they_state_are_no_names(tmp_path):
    table = rows("%.4f,%.2f,%.2f,%.4f,%.3f", T, Q, np.roll(Q, -20), T, U)
    lines = ["time,Motor angle,Set angle,time,Torque", *KEYED, *table]
    log, proposal = survey(tmp_path, lines)
    assert log.names == ("time", "Motor angle", "Set angle", "Torque")
    assert columns_of(proposal.channels) == {
        "time": "time", "position": "Motor angle", "actuator_force": "Torque",
    }  # fmt: skip
    assert proposal.channels["position"]["unit"] == "deg"
    assert proposal.channels["actuator_force"]["unit"] == "N*m"


def test_a_time_before_each_group_of_signals_is_the_clock_of_its_group(tmp_path):
    fast = rows("%.4f,%.2f,%.2f", T, Q, np.roll(Q, -20))
    slow = [*rows("%.4f,%.3f", T[::2], U[::2]), *[","] * (ROWS // 2)]
    table = [f"{a},{b}" for a, b in zip(fast, slow, strict=True)]
    log, proposal = survey(tmp_path, ["time,Motor angle,Set angle,time,Torque", *KEYED, *table])
    assert log.clocks["Torque"] == "time of Torque"
    assert columns_of(proposal.channels)["actuator_force"] == "Torque"
    read = read_columns(tmp_path / "log.csv", "log.csv", {"Torque": "channels.actuator_force"})
    assert np.allclose(read.stamps["Torque"], T[::2])


def test_messages_above_a_table_without_names_are_no_header(tmp_path):
    lines = ["MOT: Init", "MOT: Ready.", *rows("%.4f\t%.3f\t%.2f", V, U, Q)]
    log, _ = survey(tmp_path, lines, sample_rate=500.0)
    assert log.names == ("column 1", "column 2", "column 3")


def clock(seconds, form="%02d:%02d:%06.3f"):
    return [form % (s // 3600, s // 60 % 60, s % 60) for s in np.asarray(seconds).tolist()]


@pytest.mark.parametrize("form", ["{} -> {}", "[{}] {}", "[2031-02-03 {}] {}", "{}->{}"])
@pytest.mark.parametrize("device_time", [False, True])
def test_times_of_a_serial_monitor_are_a_column(tmp_path, form, device_time):
    received = clock(86_399.0 + T)  # over midnight
    sent = rows("%.2f,%.3f", Q, U)
    names = "angle_deg,torque_Nm"
    if device_time:
        sent = [f"{ms},{row}" for ms, row in zip((2 * np.arange(ROWS)).tolist(), sent, strict=True)]
        names = f"millis,{names}"
    lines = [form.format(stamp, row) for stamp, row in zip(received, sent, strict=True)]
    if "-02-" in form:
        lines = [line.replace("-03 00:", "-04 00:") for line in lines]
    head = [form.format("23:59:58.900", ""), form.format("23:59:58.950", names)]
    if "-02-" in form:
        head = [line.replace("2031-02-03 ", "2031-02-03T") for line in head]
    log, proposal = survey(tmp_path, [*head, *lines], "dump.txt")
    expected = "millis" if device_time else "received"
    assert columns_of(proposal.channels) == {
        "time": expected, "position": "angle_deg", "actuator_force": "torque_Nm",
    }  # fmt: skip
    assert any("serial monitor" in note for note in log.notes)
    assert proposal.duration == pytest.approx(T[-1], abs=1e-6)


def test_a_serial_monitor_also_stamps_pairs_of_names_and_values(tmp_path):
    sent = rows("pos:%.2f\ttorque:%.3f", Q, U)
    lines = [f"{s} -> {row}" for s, row in zip(clock(36_000 + T), sent, strict=True)]
    log, proposal = survey(tmp_path, lines, "dump.txt")
    assert log.names == ("received", "pos", "torque")
    assert proposal.channels["time"] == {"column": "received", "unit": "s"}


def test_a_serial_monitor_stamps_a_table_with_decimal_commas(tmp_path):
    sent = [row.replace(".", ",") for row in rows("%.2f;%.3f", Q, U)]
    lines = [f"{s} -> {row}" for s, row in zip(clock(36_000 + T), sent, strict=True)]
    log, _ = survey(tmp_path, lines, "dump.txt")
    read = log.read(dict.fromkeys(log.names, ""))
    assert np.array_equal(read["column 3"], U) and np.allclose(read["column 1"] - 36_000, T)


EPOCH = 1_900_000_000_123_456_789 + (2_000_000 * np.arange(ROWS, dtype=np.int64))


@pytest.mark.parametrize(
    ("names", "joined", "per_second"),
    [
        ("header.stamp.sec,header.stamp.nanosec,frame,position,effort", "header.stamp", 1),
        ("secs,nsecs,frame,position,effort", "time", 1),
        ("tv_sec,tv_usec,frame,position,effort", "tv", 1000),
        ("", "column 1 + column 2", 1),
    ],
)
def test_seconds_and_the_part_of_the_second_are_one_time(tmp_path, names, joined, per_second):
    parts = EPOCH // 10**9, EPOCH % 10**9 // per_second
    table = rows("%d,%d,base,%.2f,%.3f", *parts, Q, U)
    log, proposal = survey(tmp_path, [names, *table] if names else table)
    assert proposal.channels["time"] == {"column": joined, "unit": "s"}
    assert "nanosec" not in " ".join(log.names) and len(log.names) == 4
    read = read_columns(tmp_path / "log.csv", "log.csv", {joined: "channels.time"})
    assert np.allclose(np.diff(read.values[joined]), 0.002, atol=2e-6)
    assert any("a time in two columns" in note for note in read.notes)


def test_a_time_of_day_and_its_milliseconds_are_one_time(tmp_path):
    """Over midnight; each second alone is shared by many rows."""
    day = 86_399 + np.floor(T + 0.25)
    stamps = clock(day % 86_400, "%02d:%02d:%02d")
    parts = (1e3 * ((T + 0.25) % 1)).round().astype(int).tolist()
    table = rows("%s;%d;%.2f;%.3f", stamps, parts, Q, U)
    _, proposal = survey(tmp_path, ["Time;Milliseconds;Angle (deg);Torque (Nm)", *table])
    assert proposal.channels["time"]["column"] == "Time + Milliseconds"
    assert proposal.duration == pytest.approx(T[-1])


@pytest.mark.parametrize(
    ("whole", "part", "answer"),
    [
        ([5, 5, 6, 6], [0.2, 0.9, 0.1, 0.6], True),
        ([5, 5, 5, 5], [0.2, 0.5, 0.7, 0.9], False),  # no turn of the second tells the two apart
        ([5, 5, 6, 6], [0.2, 0.9, 0.1, 0.05], False),  # set back within a second
        ([5, 5, 6, 6], [0.2, 1.1, 0.1, 0.6], False),
        ([5, 5, 6, 6], [0.1, 0.3, 0.1, 0.2], False),  # never near a second
        ([5, 5.5, 6, 6], [0.2, 0.9, 0.1, 0.6], False),
        ([6, 6, 5, 5], [0.2, 0.9, 0.1, 0.6], False),
        ([5], [0.2], False),
    ],
)
def test_parts_of_a_second_begin_anew_where_the_second_turns(whole, part, answer):
    assert are_parts_of_time(np.array(whole), np.array(part), per_second=1.0) is answer


FRAME = "37 12 A0 FE FF FF 2C 00"


@pytest.mark.parametrize(
    ("name", "form"),
    [
        ("can.log", "({t:.6f}) can0 181#" + FRAME.replace(" ", "")),
        ("can.txt", "  can0  181   [8]  " + FRAME),
        ("can.asc", "   {t:.6f} 1  181             Rx   d 8 " + FRAME + "  Length = 228000"),
        ("can.trc", "     1)      {t:.1f}  Rx         0181  8  " + FRAME),
    ],
)
def test_frames_of_a_bus_are_refused_with_what_to_do(tmp_path, name, form):
    path = tmp_path / name
    path.write_text("; frames\n" + "\n".join(form.format(t=t) for t in T.tolist()) + "\n")
    with pytest.raises(ExperimentError, match="frames of a CAN bus.*decode them"):
        open_log(path, name)

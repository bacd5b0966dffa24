"""One table with the times of several clocks: each signal has numbers in its own rows only."""

import numpy as np
import pytest

from teleopdesign import load_experiment
from teleopdesign.cli import main
from teleopdesign.measurement.bandwidth import default_bandwidth
from teleopdesign.measurement.signals_of_log import _rate_without_pauses
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log, read_columns

T = np.arange(1500) / 100.0
Q = 0.5 * np.sin(2 * np.pi * 0.4 * T) + 0.1 * np.sin(2 * np.pi * 1.7 * T)
U = 0.01 * np.gradient(np.gradient(Q, T), T) + 0.1 * np.sign(np.gradient(Q, T))
POSITION, VELOCITY, COMMAND = "/joints/arm/position", "/joints/arm/velocity", "/command/data"


def write(path, begin=1.7e9, unit=1.0, time="__time"):
    """Position and velocity at 100 Hz, the command at 50 Hz, 2 ms after every second position."""
    rows = [(t, f"{q:.8f},{v:.8f},") for t, q, v in zip(T, Q, np.gradient(Q, T), strict=True)]
    rows += [(t + 0.002, f",,{u:.8f}") for t, u in zip(T[::2], U[::2], strict=True)]
    lines = [f"{(t + begin) / unit:.6f},{cells}" for t, cells in sorted(rows)]
    path.write_text("\n".join([f"{time},{POSITION},{VELOCITY},{COMMAND}", *lines]) + "\n")
    return path


@pytest.mark.parametrize(("begin", "unit", "time"), [(1.7e9, 1.0, "__time"), (5, 1e-3, "t [ms]")])
def test_each_signal_has_its_times_in_seconds(tmp_path, begin, unit, time):
    path = write(tmp_path / "log.csv", begin, unit, time)
    log = open_log(path, "log.csv")
    of_position, of_command = f"{time} of {POSITION}", f"{time} of {COMMAND}"
    assert log.names == (time, POSITION, VELOCITY, COMMAND, of_position, of_command)
    assert log.clocks == {POSITION: of_position, VELOCITY: of_position, COMMAND: of_command}
    wanted = {
        of_position: "channels.time",
        POSITION: "channels.position",
        COMMAND: "channels.force",
    }
    columns = read_columns(path, "log.csv", wanted)
    first = begin if begin < 1e8 else 0.0
    assert columns.values[of_position] == pytest.approx(T + first, abs=1e-5)
    assert columns.values[POSITION] == pytest.approx(Q, abs=1e-8)
    assert columns.values[COMMAND] == pytest.approx(U[::2], abs=1e-8)
    assert columns.stamps[COMMAND] == pytest.approx(T[::2] + 0.002 + first, abs=1e-5)


def test_a_survey_takes_the_position_with_its_times_and_the_command_of_another_clock(tmp_path):
    log = open_log(write(tmp_path / "log.csv"), "log.csv")
    channels = survey_log(log, "log.csv", Choices()).channels
    of_channel = {quantity: table["column"] for quantity, table in channels.items()}
    clock = f"__time of {POSITION}"
    assert of_channel == {"time": clock, "position": POSITION, "actuator_force": COMMAND}


def test_a_signal_that_begins_after_thousands_of_rows_has_its_times(tmp_path):
    lines = [f"{t / 100},{t % 7}.5," for t in range(9000)]
    lines += [f"{t / 100},{t % 7}.5,\n{t / 100 + 0.001},,{t % 5}" for t in range(9000, 12000)]
    (tmp_path / "log.csv").write_text("\n".join(["time,q,tau", *lines]) + "\n")
    log = open_log(tmp_path / "log.csv", "log.csv")
    assert log.clocks == {"q": "time of q", "tau": "time of tau"}
    assert len(log.read({"tau": ""})["tau"]) == 3000


@pytest.mark.parametrize(
    ("kept", "time"),
    [
        (0.6, "t"),  # a channel that loses readings
        (0.0, "t"),  # one that has none
        (0.4, "x"),  # no column is a time
        (0.4, "t"),  # one that loses most of them beside one that has all
    ],
)
def test_a_table_of_one_clock_stays_as_it_is(tmp_path, kept, time):
    rng = np.random.default_rng(3)
    cells = [f"{x:.3f}" if rng.random() < kept else "" for x in Q]
    lines = [f"{t},{q},{c}" for t, q, c in zip(T, Q, cells, strict=True)]
    (tmp_path / "log.csv").write_text("\n".join([f"{time},q,tau", *lines]) + "\n")
    log = open_log(tmp_path / "log.csv", "log.csv")
    assert log.names == (time, "q", "tau") and not log.clocks


@pytest.mark.parametrize("more", [0, 1])
def test_two_signals_at_one_rate_that_take_turns_have_a_clock_each(tmp_path, more):
    """Each has numbers in half of the rows, or in one row more."""
    rows = [(t, f"{q:.8f},") for t, q in zip(T, Q, strict=True)]
    rows += [(t + 0.004, f",{u:.8f}") for t, u in zip(T[more:], U[more:], strict=True)]
    lines = [f"{t:.4f},{cells}" for t, cells in sorted(rows)]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(["time,position,torque", *lines]) + "\n")
    log = open_log(path, "log.csv")
    assert log.clocks == {"position": "time of position", "torque": "time of torque"}
    channels = survey_log(log, "log.csv", Choices()).channels
    of_channel = {quantity: table["column"] for quantity, table in channels.items()}
    expected = {"time": "time of position", "position": "position", "actuator_force": "torque"}
    assert of_channel == expected


def test_readings_that_were_lost_from_two_signals_do_not_make_two_clocks(tmp_path):
    keep = np.random.default_rng(3).random((len(T), 2)) > 0.1
    cells = [
        f"{t:.4f},{f'{q:.8f}' if a else ''},{f'{u:.8f}' if b else ''}"
        for t, q, u, (a, b) in zip(T, Q, U, keep, strict=True)
    ]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(["time,position,torque", *cells]) + "\n")
    assert not open_log(path, "log.csv").clocks


@pytest.mark.parametrize("pause", [0.0, 40.0])
def test_a_pause_of_the_log_is_no_slow_signal(tmp_path, pause):
    """Stamps a second over all of the log lowered the bandwidth of a diagnosis to a tenth of it."""
    later = T + pause * (T > 6.0)
    rows = [(t, f"{q:.8f},") for t, q in zip(later, Q, strict=True)]
    rows += [(t + 0.002, f",{u:.8f}") for t, u in zip(later[::2], U[::2], strict=True)]
    log = tmp_path / "log.csv"
    lines = [f"{t:.6f},{cells}" for t, cells in sorted(rows)]
    log.write_text("\n".join(["time_s,position_rad,torque_Nm", *lines]) + "\n")
    assert main(["new", str(log), "--yes", "--output", str(tmp_path / "out")]) == 0
    experiment = load_experiment(tmp_path / "out")
    for record in experiment.records:
        assert record.rate_of("device.actuator_force") == pytest.approx(50.0, rel=0.01)
    assert default_bandwidth(experiment) > 3.0


@pytest.mark.parametrize("lost", [0.0, 0.05])
def test_bursts_and_lost_stamps_are_no_pauses(lost):
    """Two stamps 1 ms apart every 20 ms, as of a bus, and some that are lost: 100 a second."""
    stamps = np.sort(np.r_[0.02 * np.arange(500), 0.02 * np.arange(500) + 0.001])
    kept = stamps[np.random.default_rng(3).random(1000) >= lost]
    rate = _rate_without_pauses(np.r_[kept, kept + 60.0])
    assert rate == pytest.approx(len(kept) / 10.0, rel=0.02)
    assert _rate_without_pauses(np.zeros(1)) == 0.0

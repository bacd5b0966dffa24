"""Tables of one run side by side in a folder: each with its own clock."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.cli import main
from teleopdesign.measurement.tables import open_log

T = np.arange(4000) / 500.0
Q = 0.5 * np.sin(2 * np.pi * 0.4 * T) + 0.1 * np.sin(2 * np.pi * 1.7 * T)
HAND = 0.2 * np.sin(2 * np.pi * 0.9 * T)
U = 0.01 * np.gradient(np.gradient(Q, T), T) + 0.1 * np.sign(np.gradient(Q, T)) - HAND


def table(path, names, *columns):
    path.parent.mkdir(exist_ok=True)
    rows = np.column_stack(columns)
    np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=",".join(names), comments="")


@pytest.fixture
def run(tmp_path):
    """A drive at 500 Hz in s, a sensor at 250 Hz in ms that begins 10 ms later."""
    table(tmp_path / "run" / "drive.csv", ["t_s", "q_rad", "tau_Nm"], T + 3.0, Q, U)
    late = np.interp(T[::2] + 0.01, T, HAND)
    table(tmp_path / "run" / "sensor.csv", ["t_ms", "hand_Nm"], 1e3 * (T[::2] + 3.01), late)
    return tmp_path / "run"


def test_a_link_that_leads_out_of_the_folder_is_not_followed(run, tmp_path):
    table(tmp_path / "else" / "other.csv", ["t_s", "secret"], T, Q)
    (run / "other.csv").symlink_to(tmp_path / "else" / "other.csv")
    assert not [name for name in open_log(run, "run").names if "secret" in name]


def test_two_logs_that_are_parts_of_one_run_are_refused_with_what_to_do(run, tmp_path, capsys):
    logs = [str(run / "drive.csv"), str(run / "sensor.csv")]
    assert main(["new", *logs, "--yes", "--output", str(tmp_path / "arm")]) == 2
    assert "put them into a folder and give the folder" in capsys.readouterr().err


NS = 1_700_000_000_000_000_000 + 2_000_000 * np.arange(4000)


@pytest.mark.parametrize(
    ("name", "stamps"),
    [
        ("time", NS),  # whole nanoseconds since 1970, as ROS and pandas write them
        ("time", NS.astype("M8[ns]")),
        ("time", NS.astype("M8[ns]").astype("M8[us]")),
        ("time", 1e-9 * NS),
        ("time_ms", 1e-6 * NS),
        ("time", 1e-6 * NS),  # no unit: steps of 2 are those of milliseconds
    ],
)
def test_tables_whose_clocks_count_in_any_way_run_at_the_same_time(tmp_path, name, stamps):
    folder = tmp_path / "run"
    folder.mkdir()
    np.savez(folder / "a.npz", **{name: stamps, "q": Q})
    later = 1e-9 * (NS[::2] + 250_000_000)
    np.savez(folder / "b.npz", t_s=later, hand=HAND[::2])
    log = open_log(folder, "run")
    first, second = f"a.{name}", "b.t_s"
    read = log.read({first: "channels.time", second: "channels.time", "a.q": "channels.position"})
    assert log.units[first] == log.units[second] == "s"
    # floats of a date in seconds are a quarter of a microsecond apart
    assert np.asarray(read[first]) == pytest.approx(T, abs=1e-6)
    assert np.asarray(read[second]) == pytest.approx(T[::2] + 0.25, abs=1e-6)
    assert log.clocks["a.q"] == first and first not in log.clocks
    assert np.array_equal(np.asarray(read["a.q"]), Q)


@pytest.mark.parametrize(
    ("begin", "shares"), [(3.9, True), (4.1, False), (-3.9, True), (-4.1, False)]
)
def test_tables_run_at_the_same_time_for_half_of_the_shorter_at_least(tmp_path, begin, shares):
    """8 s each; the other table is longer and ends or begins beside it."""
    folder = tmp_path / "run"
    table(folder / "a.csv", ["t_s", "q"], T, Q)
    long = np.arange(8000) / 500.0
    table(folder / "b.csv", ["t_s", "hand"], long + (begin if begin > 0 else begin - 8.0), long)
    if shares:
        assert len(open_log(folder, "run").names) == 4
        return
    with pytest.raises(ExperimentError, match="do not run at the same time"):
        open_log(folder, "run")

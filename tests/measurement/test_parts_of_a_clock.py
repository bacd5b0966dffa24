"""A clock whose seconds are read before or after their fraction turns late or early in one row."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, U, look

from teleopdesign.measurement.stamps import unwrap_stamps
from teleopdesign.measurement.tables import open_log, read_columns

SINCE = 0.005 * np.arange(1000) + 0.0004 * np.random.default_rng(5).random(1000)


def clock(period, start, *, early=False, rows=1):
    """Stamps from `start` on; at each turn of a period `rows` are displaced by it, and which."""
    true = start + SINCE
    turns = np.flatnonzero(np.diff(np.floor(true / period))) + 1
    first = turns - rows if early else turns
    at = np.concatenate([np.arange(k, k + rows) for k in first])
    shown = true.copy()
    shown[at] += period if early else -period
    return true, shown, len(at)


@pytest.mark.parametrize("unit", [1.0, 1e3, 1e6])
@pytest.mark.parametrize("rows", [1, 3])
@pytest.mark.parametrize("early", [False, True])
@pytest.mark.parametrize(
    ("period", "start", "name"),
    [(1.0, 24.7, "second"), (60.0, 118.0, "minute"), (3600.0, 7197.0, "hour")],
)
def test_rows_at_the_turn_of_a_part_are_moved_by_it(unit, rows, early, period, start, name):
    true, shown, count = clock(period, start, early=early, rows=rows)
    whole, notes = unwrap_stamps(unit * shown)
    assert whole == pytest.approx(unit * true, abs=1e-9 * unit * start)
    when, more = ("early", "earlier") if early else ("late", "later")
    of = "row" if count == 1 else "rows"
    assert notes == (f"the {name} turns {when} in {count} {of}: read a {name} {more}",)


def test_a_clock_that_was_set_back_and_pauses_are_left():
    for back in (
        np.r_[SINCE, SINCE[-1] - 0.995 + SINCE],  # set back, and never forward again
        np.r_[SINCE, SINCE[-1] + 1.005 + SINCE],  # a pause
        np.r_[SINCE, SINCE[-1] - 0.995 + SINCE[:90], SINCE[-1] + 0.5 + SINCE],  # too long for it
        np.r_[SINCE, SINCE[-1] - 0.7, SINCE[-1] + 0.3 + SINCE],  # by no whole second
    ):
        whole, notes = unwrap_stamps(back)
        assert np.array_equal(whole, back) and notes == ()
    slow = np.arange(100.0)
    slow[50] -= 1.0
    assert unwrap_stamps(slow)[1] == (), "a row each second tells no second apart"


def test_seconds_that_turn_late_beside_midnight_and_rows_without_a_stamp():
    true, shown, _ = clock(1.0, 86_397.3)
    at_midnight = int(np.argmax(true >= 86_400.0))
    shown[at_midnight] = true[at_midnight]
    shown[shown >= 86_400.0] -= 86_400.0
    shown[[3, 300]] = np.nan
    whole, notes = unwrap_stamps(shown)
    there = np.isfinite(shown)
    assert whole[there] == pytest.approx(true[there])
    assert [n.partition(":")[0] for n in notes] == [
        "the second turns late in 4 rows",
        "the time of day begins anew at midnight",
    ]


def test_a_clock_with_late_seconds_is_the_time_beside_a_counter():
    """Of rows each 20 ms a fiftieth goes back in time, where no time may."""
    _, shown, _ = clock(1.0, 24.7)
    rows = np.sort(np.r_[np.arange(0, 1000, 4), np.flatnonzero(np.diff(shown) < 0) + 1])
    rows = np.unique(rows)
    t = SINCE[rows]
    columns = {"Timestamp": shown[rows], "Step": 1e3 * t, "theta": np.sin(9.0 * t)}
    survey = look({**columns, "torque": np.sign(np.cos(9.0 * t)) + np.sin(9.0 * t)})
    assert survey.channels["time"]["column"] == "Timestamp"
    assert survey.duration == pytest.approx(SINCE[rows[-1]] - SINCE[0])


def test_times_of_day_in_a_file_are_read_so(tmp_path):
    """The milliseconds of 0.997, 1.002, 1.007 s beside the seconds of the row before."""
    lines = ["time,q"]
    for k in range(0, 3000, 5):
        second, part = divmod(k + 997, 1000)
        shown = second - (part < 5)
        lines.append(f"14:43:{24 + shown:02d}.{part:03d},{k}")
    (tmp_path / "log.csv").write_text("\n".join(lines))
    assert len(open_log(tmp_path / "log.csv", "log.csv").names) == 2
    columns = read_columns(tmp_path / "log.csv", "log.csv", {"time": "channels.time"})
    assert np.diff(columns.values["time"]) == pytest.approx(0.005)
    assert columns.notes == ("the second turns late in 3 rows: read a second later",)


@pytest.mark.parametrize(
    ("name", "step"),
    [
        ("dt [us]", 2000.0),
        ("timestep__us", 2000.0),
        ("dt", 0.002),
        ("dt_ms", 2.0),
        ("Δt (s)", 0.002),
    ],
)
def test_a_column_of_time_steps_tells_the_rate(name, step):
    """The rate was assumed to be 1000 Hz beside "dt [us]" of 2000."""
    late = 1.0 + 0.02 * np.random.default_rng(1).standard_normal(len(Q))
    result = look({name: step * late, "angle_rad": Q, "torque_Nm": U})
    assert result.channels["sample_rate"]["value"] == pytest.approx(500.0, rel=0.01)
    assert name in result.guesses["sample_rate"]


def test_a_step_that_is_far_from_even_tells_no_rate():
    steps = np.random.default_rng(1).exponential(0.01, len(Q)) ** 2
    result = look({"dt": steps, "angle_rad": Q, "torque_Nm": U})
    assert result.channels["sample_rate"]["value"] == 1000.0

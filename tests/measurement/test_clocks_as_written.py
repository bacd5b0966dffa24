"""Stamps as loggers write them: zones, midnight, wraps of counters, days of a spreadsheet."""

import datetime
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from measurement.columns_by_hand import Q as ANGLE
from measurement.columns_by_hand import U as TORQUE
from measurement.columns_by_hand import look

from teleopdesign.measurement.stamps import seconds_since_first, unwrap_stamps
from teleopdesign.measurement.survey import Choices, spans_of, survey_log
from teleopdesign.measurement.tables import open_log, read_columns

ROWS = 800
T = 0.004 * np.arange(ROWS)
Q = np.rad2deg(np.sin(2 * np.pi * 0.7 * T) + 0.2 * np.sin(2 * np.pi * 2.1 * T))
U = 0.02 * np.gradient(np.gradient(Q, T), T) + 9.0 * np.sign(np.gradient(Q, T))
#: five seconds before the hour that comes twice in autumn ends, in universal time
AUTUMN = datetime.datetime(2026, 10, 25, 0, 59, 58, tzinfo=datetime.UTC)
BERLIN = ZoneInfo("Europe/Berlin")


def log_with(folder, stamps, head="Time"):
    lines = [f'"{s}",{q:.4f},{u:.4f}' for s, q, u in zip(stamps, Q, U, strict=True)]
    path = folder / "log.csv"
    path.write_text("\n".join([f"{head},Angle (deg),Torque (Nm)", *lines]) + "\n", "utf-8")
    return path


def texts(form, begin=AUTUMN, zone=BERLIN):
    instants = [(begin + datetime.timedelta(seconds=t)).astimezone(zone) for t in T.tolist()]
    return [f"{instant:{form}}" for instant in instants]


@pytest.mark.parametrize(
    "form",
    [
        "%Y-%m-%dT%H:%M:%S.%f%z",
        # without a zone the clock goes back an hour
        "%d.%m.%Y %H:%M:%S.%f", "%m/%d/%Y %I:%M:%S.%f %p", "%H:%M:%S.%f",
    ],
)  # fmt: skip
def test_an_hour_that_comes_twice_is_two_hours(tmp_path, form):
    path = log_with(tmp_path, texts(form))
    survey = survey_log(open_log(path, "log.csv"), "log.csv", Choices())
    assert survey.duration == pytest.approx(T[-1], abs=1e-6)
    stamps = read_columns(path, "log.csv", {"Time": "channels.time"}).values["Time"]
    assert np.allclose(stamps - stamps[0], T, atol=1e-6)


@pytest.mark.parametrize("form", ["%H:%M:%S.%f", "%I:%M:%S.%f", "%I:%M:%S.%f %p"])
def test_a_time_of_day_counts_on_over_midnight_and_says_so(tmp_path, form):
    begin = datetime.datetime(2026, 11, 20, 23, 59, 58, tzinfo=datetime.UTC)
    path = log_with(tmp_path, texts(form, begin, datetime.UTC))
    columns = read_columns(path, "log.csv", {"Time": "channels.time", "Angle (deg)": ""})
    stamps = columns.values["Time"]
    assert np.allclose(stamps - stamps[0], T, atol=1e-6)
    # a dial of twelve hours says 11, then 12: it goes back an hour later
    assert any("time counts on" in note for note in columns.notes) or form == "%I:%M:%S.%f"


@given(
    bits=st.sampled_from([16, 24, 32]),
    step=st.integers(1, 100),
    before=st.integers(1, ROWS - 1),
    lost=st.integers(1, 9),
)
def test_a_counter_that_wraps_counts_on(bits, step, before, lost):
    places = np.r_[np.arange(before), np.arange(before, ROWS) + lost]
    count = 2.0**bits + (places - before) * step
    whole, notes = unwrap_stamps(np.mod(count, 2.0**bits))
    assert np.array_equal(np.diff(whole), np.diff(count))
    assert len(notes) == 1 and f"{bits} bits" in notes[0]


@given(at=st.integers(100, 700), to=st.floats(-100.0, 3.0))
def test_a_clock_that_was_set_anew_is_no_wrap(at, to):
    stamps = 100.0 + T
    stamps[at:] += to - stamps[at]
    whole, notes = unwrap_stamps(stamps)
    assert whole is stamps and notes == ()
    since = seconds_since_first(stamps)
    assert np.allclose(np.diff(since), 0.004, atol=1e-9)


def test_the_spans_of_a_clock_that_was_set_back_hold_rows_of_both_sides(tmp_path):
    stamps = np.r_[5000.0 + T[:300], T[300:]]
    path = log_with(tmp_path, [f"{s:.4f}" for s in stamps.tolist()])
    survey = survey_log(open_log(path, "log.csv"), "log.csv", Choices())
    assert survey.duration == pytest.approx(T[-1], abs=1e-6)
    (_, cut), (_, end) = spans_of(survey.duration)
    assert 0 < cut < T[-1] < end


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
    late = 1.0 + 0.02 * np.random.default_rng(1).standard_normal(len(ANGLE))
    result = look({name: step * late, "angle_rad": ANGLE, "torque_Nm": TORQUE})
    assert result.channels["sample_rate"]["value"] == pytest.approx(500.0, rel=0.01)
    assert name in result.guesses["sample_rate"]


def test_a_step_that_is_far_from_even_tells_no_rate():
    steps = np.random.default_rng(1).exponential(0.01, len(ANGLE)) ** 2
    result = look({"dt": steps, "angle_rad": ANGLE, "torque_Nm": TORQUE})
    assert result.channels["sample_rate"]["value"] == 1000.0

"""Stamps that wrap, begin anew or are set back count on."""

import numpy as np
import pytest

from teleopdesign.measurement.stamps import seconds_since_first, unwrap_stamps


def test_how_often_a_counter_wraps_is_reported_and_rows_without_a_stamp_stay_so():
    counts = 100 * np.arange(2000.0)
    stamps = counts % 2**16
    stamps[[5, 700, 1500]] = np.nan
    whole, notes = unwrap_stamps(stamps)
    there = np.isfinite(stamps)
    assert np.array_equal(whole[there], counts[there])
    assert np.isnan(whole[~there]).all()
    assert notes == ("a counter of 16 bits wraps 3 times: time counts on",)


@pytest.mark.parametrize("unit", [1.0, 1e3, 1e6, 1e9])
@pytest.mark.parametrize(
    ("lost", "words"),
    [(3600.0, "an hour"), (43_200.0, "twelve hours"), (86_400.0, "midnight"), (604_800.0, "week")],
)
def test_a_clock_that_begins_anew_counts_on_in_any_unit(unit, lost, words):
    since = 0.01 * np.arange(3000)
    clock = lost - 10.0 + since
    clock[clock >= lost - 1e-9] -= lost
    whole, notes = unwrap_stamps(unit * clock)
    assert whole == pytest.approx(unit * (lost - 10.0 + since), rel=1e-12, abs=1e-5 * unit)
    (note,) = notes
    assert words in note


def test_a_clock_that_was_set_back_goes_on_a_usual_step_later():
    stamps = np.r_[50.0 + 0.01 * np.arange(300), 10.0 + 0.01 * np.arange(300)]
    since = seconds_since_first(stamps)
    assert since == pytest.approx(0.01 * np.arange(600))
    # rows out of order by up to five keep their stamps
    for rows, goes_on in [(5, False), (6, True)]:
        stamps = 7.0 + 0.01 * np.arange(100)
        stamps[50:] -= 0.01 * (rows + 1)
        expected = stamps - 7.0 + (0.01 * (rows + 1) if goes_on else 0.0) * (np.arange(100) >= 50)
        assert seconds_since_first(stamps) == pytest.approx(expected)
    stamps[[0, 30]] = np.nan
    since = seconds_since_first(stamps)
    assert since[1] == 0.0 and np.isnan(since[[0, 30]]).all()
    assert since[-1] == pytest.approx(0.98)
    assert np.isnan(seconds_since_first(np.full(3, np.nan))).all()


def test_stamps_that_only_fall_and_stamps_that_rows_share_are_left():
    falling = np.arange(100.0)[::-1]
    assert unwrap_stamps(falling)[0] is falling and seconds_since_first(falling)[-1] == -99.0
    shared = np.repeat(0.01 * np.arange(100), 3)
    shared[200] -= 0.02  # a row out of order, by two steps
    assert seconds_since_first(shared) == pytest.approx(shared)

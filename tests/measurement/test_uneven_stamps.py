"""Rows that are lost, twice or out of order, pauses and clocks set anew, by hand."""

import math

import numpy as np
import pytest

from teleopdesign.measurement.record_clock import clock_of, segments_of


def clock_by(stamps, labels=None):
    return clock_of(stamps, segments_of(labels, len(stamps)), "log")


def counts_of(clock, noun):
    """The numbers of rows or pauses in the remarks of a clock: "5 rows out of order"."""
    words = [observed.split() for observed, _, _ in clock.remarks]
    return [int(number) for number, what, *_ in words if what.startswith(noun)]


@pytest.mark.parametrize(("lost", "pauses"), [((5, 5), 0), ((6, 5), 1), ((6, 40), 2)])
def test_a_pause_parts_the_rows_and_the_longest_is_reported(lost, pauses):
    h, places = 0.01, np.arange(900)
    for at, n in zip((200, 500), lost, strict=True):
        places[at:] += n
    clock = clock_by(h * places)
    assert (
        counts_of(clock, "pause") == [pauses] * (pauses > 0) and len(clock.segments) == pauses + 1
    )
    longest = f"the longest {h * (max(lost) + 1):.3g} s"
    assert not pauses or any(longest in observed for observed, _, _ in clock.remarks)
    # the even time of each stretch is that of its stamps
    assert clock.time[clock.places] == pytest.approx(h * places)
    assert [s.stop - s.start for s in clock.of_rows] == (
        [900] if not pauses else [200, 700] if pauses == 1 else [200, 300, 400]
    )


def test_a_clock_that_was_set_anew_begins_a_stretch_and_time_goes_on():
    h = 0.01
    for rows, begins in [(5, 0), (6, 1)]:  # back by so many of them and the step itself
        stamps = 5.0 + h * np.arange(400)
        stamps[200:] -= h * (rows + 0.9)
        assert clock_by(stamps).set_back == (begins > 0)
    stamps = np.r_[90.0 + h * np.arange(300), 20.0 + h * np.arange(300)]
    clock = clock_by(stamps)
    assert clock.set_back and len(clock.of_rows) == 2
    assert clock.time == pytest.approx(90.0 + h * np.arange(600))
    # segments of a user may begin anew: each has its time
    clock = clock_by(stamps, labels=np.repeat([0, 1], 300))
    assert clock.time == pytest.approx(stamps)


def test_stamps_of_no_clock_get_a_grid_of_as_many_samples():
    rng = np.random.default_rng(0)
    stamps = np.sort(rng.uniform(0.0, 8.0, 800))
    clock = clock_by(stamps)
    assert clock.jitter == math.inf and clock.lost == 0
    assert clock.sample_time == pytest.approx(np.ptp(stamps) / 799, rel=0.1)
    near = np.abs(clock.time[clock.places] - stamps)
    assert near.max() <= 0.5 * clock.sample_time + 1e-9

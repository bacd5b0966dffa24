"""Stamps of a log by hand: unit, wraps, clocks set back, order, and the even clock in them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.even_clock import even_clock, is_only_rounded
from teleopdesign.measurement.record_clock import segments_of
from teleopdesign.measurement.stamp_unit import unit_of_steps
from teleopdesign.measurement.uneven_stamps import rows_in_order, sparse_clock
from teleopdesign.measurement.wrapped_stamps import seconds_since_first, unwrap_stamps

# units


@pytest.mark.parametrize(
    ("step", "unit"),
    [
        (1e-4, "s"),
        (0.19, "s"),
        (0.21, "ms"),
        (1.0, "ms"),
        (199.0, "ms"),
        (201.0, "us"),
        (1.9e5, "us"),
        (2.1e5, "ns"),
        (1e6, "ns"),
        (1e9, "ns"),
    ],
)
def test_a_log_has_from_five_rows_a_second_to_a_hundred_thousand(step, unit):
    stamps = 1e6 + step * np.arange(300)
    found, why = unit_of_steps(stamps)
    assert found == unit and (why == "") == (unit == "s")
    assert unit == "s" or why.endswith(f"only in {unit}") and f"{step:.4g}" in why
    # a row that says no time, and some that go back, change nothing
    stamps[[50, 90]] = np.nan
    stamps[100:] -= 40 * step
    assert unit_of_steps(stamps)[0] == unit


def test_seconds_that_are_too_fine_are_a_guess():
    assert unit_of_steps(9e-6 * np.arange(400_000)) == (
        "s", "steps of 9e-06 are those of a log only in s"
    )  # fmt: skip


@pytest.mark.parametrize(
    ("step", "length", "unit"),
    [
        (0.001, 60.0, "day"),
        (0.19, 60.0, "day"),
        (0.21, 60.0, "s"),  # steps of 2.4e-6: no day's log, nor is it in seconds a long one
        (0.001, 0.9, "s"),  # in days less than a second long
        (0.1, 85_000.0, "day"),
        (0.15, 87_000.0, "s"),  # in seconds longer than a second
    ],
)
def test_steps_of_a_spreadsheet_are_days(step, length, unit):
    """Seconds of which 86 400 are one."""
    stamps = 46_000.0 + np.arange(0.0, length, step) / 86_400.0
    assert unit_of_steps(stamps - 46_000.0)[0] == unit


# wraps


@given(
    bits=st.sampled_from([16, 24, 32]),
    step=st.integers(3, 120),
    late=st.integers(1, 20),
)
def test_a_counter_that_wraps_counts_on(bits, step, late):
    """Over the wrap up to twenty rows may be lost."""
    wrap = 2**bits
    counts = step * np.arange(-400, 100) + wrap - 1  # the 401st is the last before the wrap
    counts[401:] += (late - 1) * step
    stamps = (counts % wrap).astype(float)
    whole, notes = unwrap_stamps(stamps)
    assert np.array_equal(np.diff(whole), np.diff(counts)) and whole[0] == stamps[0]
    assert notes == (f"a counter of {bits} bits wraps: time counts on",)


def test_how_often_a_counter_wraps_is_said_and_rows_without_a_stamp_stay_so():
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


def test_a_step_back_that_leaves_no_step_like_the_others_is_no_wrap():
    forward = 1000.0 + 0.01 * np.arange(400)
    for lost in (3599.0, 3600.3, 40_000.0):
        back = np.r_[forward, forward - lost]
        whole, notes = unwrap_stamps(back)
        assert whole is back and notes == ()
    # a wrap that leaves 21 steps is a pause, and none of a counter
    far = np.r_[forward, forward[-1] - 3600.0 + 0.21 + 0.01 * np.arange(400)]
    assert unwrap_stamps(far)[1] == ()
    near = np.r_[forward, forward[-1] - 3600.0 + 0.19 + 0.01 * np.arange(400)]
    assert unwrap_stamps(near)[0][400:] == pytest.approx(far[400:] + 3600.0 - 0.02)
    # rows of blocks of few are counted anew
    blocks = np.tile(150.0 * np.arange(400), 3)
    assert unwrap_stamps(blocks)[1] == ()
    assert unwrap_stamps(forward)[0] is forward and unwrap_stamps(forward[:1])[1] == ()


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


# the even clock


@given(
    lengths=st.lists(st.integers(20, 300), min_size=1, max_size=4),
    period=st.floats(4e-3, 0.05),
    seed=st.integers(0, 1000),
)
@settings(max_examples=25)
def test_an_even_clock_is_the_line_through_the_stamps_of_all_segments(lengths, period, seed):
    """One slope for all, and a beginning of each: by the least squares of one matrix."""
    rng = np.random.default_rng(seed)
    lengths = [max(n, math.ceil(1.1 / period / len(lengths))) for n in lengths]
    parts = [
        100.0 * k + period * (np.arange(n) + 0.05 * rng.uniform(-1, 1, n))
        for k, n in enumerate(lengths)
    ]
    stamps = np.concatenate(parts)
    segments = segments_of(np.repeat(np.arange(len(lengths)), lengths), len(stamps))
    clock = even_clock(stamps, segments, "log")
    matrix = np.zeros((len(stamps), 1 + len(segments)))
    for k, s in enumerate(segments):
        matrix[s, 0] = np.arange(s.stop - s.start)
        matrix[s, k + 1] = 1.0
    solution, *_ = np.linalg.lstsq(matrix, stamps, rcond=None)
    assert clock.sample_time == pytest.approx(solution[0], rel=1e-9)
    assert clock.time == pytest.approx(matrix @ solution, abs=1e-8)
    assert clock.jitter == pytest.approx(
        np.sqrt(np.mean((stamps - matrix @ solution) ** 2)), rel=1e-4
    )
    assert clock.exact and clock.segments == segments and clock.lost == 0


@pytest.mark.parametrize(("digits", "rate"), [(3, 1024.0), (2, 60.0), (4, 3000.0), (6, 333_333.0)])
def test_stamps_that_are_rounded_lie_on_their_clock_and_others_do_not(digits, rate):
    n = 1200
    stamps = np.round(np.arange(n) / rate, digits)
    whole = (slice(0, n),)
    assert is_only_rounded(stamps, whole, 1.0 / rate)
    # one row more in the middle: the second half is a row later
    late = np.round(
        (np.arange(n) + (np.arange(n) >= n // 2) * 3 * max(1, 10.0**-digits * rate)) / rate, digits
    )
    assert not is_only_rounded(late, whole, 1.0 / rate)


# rows lost, twice, out of order


def clock_by(stamps, labels=None, same=None):
    segments = segments_of(labels, len(stamps))
    same = np.zeros(len(stamps), dtype=bool) if same is None else same
    parts, *changes = rows_in_order(stamps, segments, same)
    return sparse_clock(stamps, parts, tuple(changes), "log"), parts, changes


@given(seed=st.integers(0, 10_000), jitter=st.floats(0.0, 0.1))
def test_rows_that_are_missing_leave_their_places(seed, jitter):
    rng = np.random.default_rng(seed)
    places = np.flatnonzero(rng.random(600) > 0.05)
    if np.diff(places).max() > 6:
        return
    h = 0.004
    stamps = 30.0 + h * (places + jitter * rng.uniform(-1, 1, len(places)))
    clock, parts, changes = clock_by(stamps)
    assert changes == [0, 0, 0] and len(parts) == 1
    assert np.array_equal(clock.places, places - places[0])
    assert len(clock.time) == places[-1] - places[0] + 1
    assert clock.lost == len(clock.time) - len(places)
    assert clock.sample_time == pytest.approx(h, rel=1e-3)
    assert clock.time[0] == pytest.approx(30.0 + h * places[0], abs=0.2 * h)
    assert clock.jitter <= jitter * h and clock.gaps == 0 and not clock.exact


@pytest.mark.parametrize(("lost", "pauses"), [((5, 5), 0), ((6, 5), 1), ((6, 40), 2)])
def test_a_pause_parts_the_rows_and_the_longest_is_said(lost, pauses):
    h, places = 0.01, np.arange(900)
    for at, n in zip((200, 500), lost, strict=True):
        places[at:] += n
    clock, *_ = clock_by(h * places)
    assert clock.gaps == pauses and len(clock.segments) == pauses + 1
    expected = h * (max(lost) + 1) if pauses else 0.0
    assert clock.longest_gap == pytest.approx(expected)
    # the even time of each stretch is that of its stamps
    assert clock.time[clock.places] == pytest.approx(h * places)
    assert [s.stop - s.start for s in clock.of_rows] == (
        [900] if not pauses else [200, 700] if pauses == 1 else [200, 300, 400]
    )


def test_rows_twice_are_dropped_and_rows_out_of_order_moved():
    h = 0.01
    order = np.arange(500)
    order[[100, 101]] = [101, 100]
    order[[200, 201, 202]] = [202, 200, 201]
    order = np.insert(order, 300, 299)
    stamps = h * order
    clock, (part,), changes = clock_by(stamps)
    assert changes == [1, 5, 0] and np.all(np.diff(stamps[part]) > 0) and len(part) == 500
    assert (clock.dropped, clock.sorted, clock.restarts) == (1, 5, 0)
    # a row that says the same again less than a quarter of a step later is a repeat as well
    for early, same, dropped in [(0.24, True, 1), (0.26, True, 0), (0.24, False, 0)]:
        stamps = np.insert(h * np.arange(500), 300, h * (299 + early))
        says = np.zeros(501, dtype=bool)
        says[300] = same
        parts, *changes = rows_in_order(stamps, (slice(0, 501),), says)
        assert changes[0] == dropped and len(parts[0]) == 501 - dropped


def test_a_clock_that_was_set_anew_begins_a_stretch_and_time_goes_on():
    h = 0.01
    for rows, begins in [(5, 0), (6, 1)]:  # back by so many of them and the step itself
        stamps = 5.0 + h * np.arange(400)
        stamps[200:] -= h * (rows + 0.9)
        _, *changes = rows_in_order(stamps, (slice(0, 400),), np.zeros(400, dtype=bool))
        assert changes[2] == begins
    stamps = np.r_[90.0 + h * np.arange(300), 20.0 + h * np.arange(300)]
    clock, parts, changes = clock_by(stamps)
    assert changes == [0, 0, 1] and len(parts) == 2 and clock.gaps == 0
    assert clock.time == pytest.approx(90.0 + h * np.arange(600))
    # segments of a user may begin anew: each has its time
    clock, *_ = clock_by(stamps, labels=np.repeat([0, 1], 300))
    assert clock.time == pytest.approx(stamps)


@pytest.mark.parametrize(("share", "counted"), [(0.019, False), (0.021, True)])
def test_stamps_that_many_rows_share_are_counted(share, counted):
    h, n = 0.01, 1000
    twice = round(share * n)
    stamps = np.sort(np.r_[h * np.arange(n - twice), h * np.arange(10, 10 + twice)])
    clock, *_ = clock_by(stamps)
    assert clock.counted == counted
    if counted:
        assert clock.sample_time == pytest.approx(h * (n - twice - 1) / (n - 1))
        assert clock.time == pytest.approx(np.linspace(stamps[0], stamps[-1], n))


def test_stamps_of_no_clock_get_a_grid_of_as_many_samples():
    rng = np.random.default_rng(0)
    stamps = np.sort(rng.uniform(0.0, 8.0, 800))
    clock, *_ = clock_by(stamps)
    assert clock.jitter == math.inf and clock.lost == 0
    assert clock.sample_time == pytest.approx(np.ptp(stamps) / 799, rel=0.1)
    near = np.abs(clock.time[clock.places] - stamps)
    assert near.max() <= 0.5 * clock.sample_time + 1e-9

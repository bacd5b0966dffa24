"""The even clock in stamps is their line of least squares."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.even_clock import even_clock, is_only_rounded
from teleopdesign.measurement.record_clock import segments_of


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


@pytest.mark.parametrize(("off", "rounded"), [(1, True), (2, False)])
def test_one_row_may_lie_off_by_half_of_the_last_digit_and_a_fifth_of_a_row(off, rounded):
    """Of 4 ms, written in ms, on two segments that begin anew: up to 1.3 ms."""
    stamps = np.tile(0.004 * np.arange(300), 2)
    stamps[450] += 0.001 * off
    segments = (slice(0, 300), slice(300, 600))
    assert is_only_rounded(stamps, segments, 0.004) == rounded


def test_segments_of_one_row_each_have_no_clock():
    stamps = 0.01 * np.arange(100)
    assert even_clock(stamps, tuple(slice(k, k + 1) for k in range(100)), "log") is None
    assert even_clock(stamps[::-1], (slice(0, 100),), "log") is None
    assert even_clock(np.full(100, np.nan), (slice(0, 100),), "log") is None

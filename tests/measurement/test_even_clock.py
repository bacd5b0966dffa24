"""The even clock in stamps is their line of least squares."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.record_clock import clock_of, segments_of


@given(
    lengths=st.lists(st.integers(70, 300), min_size=1, max_size=4),
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
    clock = clock_of(stamps, segments, np.zeros(len(stamps), dtype=bool), "log")
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

"""What the ends of a record do to its spectrum, and what a low-pass leaves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.filtering import spectrum

H = 0.005
T = H * np.arange(4000)
SWING = np.sin(2 * np.pi * 0.6 * T) + 0.4 * np.sin(2 * np.pi * 1.7 * T + 1.0)


@given(
    n=st.integers(2, 500),
    level=st.floats(-10, 10),
    slope=st.floats(-10, 10),
    cutoff=st.floats(1.0, 90.0),
)
@settings(max_examples=40)
def test_a_line_is_a_line_behind_the_low_pass_inside_and_one_of_less_at_no_end(
    n, level, slope, cutoff
):
    """Level and slope go on beyond both ends: nothing rings there."""
    line = level + slope * H * np.arange(n)
    grid = spectrum(n, H)
    left = grid.multiply(line, np.ones(len(grid.frequency))) - line
    assert np.abs(left).max() < 1e-9
    assert len(grid.frequency) == grid.length // 2 + 1
    if n > 400:
        low = grid.multiply(line, grid.lowpass(cutoff))
        inner = slice(n // 3, -n // 3)
        # what closes the circle far away leaves a little of itself
        assert np.abs(low - line)[inner].max() < 0.02 * (abs(slope) * H * n + 1e-9) + 1e-9


@pytest.mark.parametrize("cutoff", [5.0, 40.0, 99.0])
@pytest.mark.parametrize("order", [2, 4, 8])
def test_a_low_pass_leaves_half_at_its_cutoff_and_nothing_at_the_end_of_the_band(cutoff, order):
    grid = spectrum(4000, H)
    gain = grid.lowpass(cutoff, order=order)
    assert gain[0] == 1.0 and np.all(np.diff(gain) <= 0)
    assert np.interp(cutoff, grid.frequency, gain) == pytest.approx(0.5, abs=0.02)
    assert gain[-1] < 1e-6 or cutoff > 98.0
    wide = grid.lowpass(1e4)
    assert wide[: len(wide) // 2].min() > 0.999


def test_a_signal_is_read_later_by_moving_what_is_to_come_forward():
    grid = spectrum(4000, H)
    inner = slice(400, -400)
    for time in (0.003, -0.02):
        moved = grid.multiply(SWING, grid.ahead(time))
        later = np.sin(2 * np.pi * 0.6 * (T + time)) + 0.4 * np.sin(
            2 * np.pi * 1.7 * (T + time) + 1.0
        )
        assert moved[inner] == pytest.approx(later[inner], abs=1e-3)

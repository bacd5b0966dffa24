"""Filters of records against definitions that are written out here, with no line of the package."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from teleopdesign.measurement.filtering import spectrum
from teleopdesign.measurement.zero_phase import margin, zero_phase


@pytest.mark.parametrize("signals", [1, 3])
def test_the_low_pass_is_the_butterworth_filter_forward_and_backward(signals):
    y = np.cumsum(np.random.default_rng(1).normal(size=(signals, 2000)), axis=1)
    sos = butter(4, 20.0, fs=1000.0, output="sos")
    expected = sosfiltfilt(sos, y, padtype="odd", padlen=margin(2000, 1e-3))
    assert zero_phase(y, 20.0, 1e-3) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("parts", "which"), [(1, 0), (4, 0), (4, 3)])
def test_a_held_value_acts_as_its_mean_over_the_part_of_a_row(parts, which):
    """Of exp(j w t): the integral over that part, by its closed form."""
    grid = spectrum(400, 1e-2)
    w = 2 * np.pi * grid.frequency[1:]
    begin, end = 1e-2 * which / parts, 1e-2 * (which + 1) / parts
    expected = (np.exp(-1j * w * begin) - np.exp(-1j * w * end)) / (1j * w * 1e-2)
    assert grid.hold(parts, which)[1:] == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert grid.hold(parts, which)[0] == pytest.approx(1 / parts)

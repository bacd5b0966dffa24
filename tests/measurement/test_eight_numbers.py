"""Eight numbers as one value do what numpy does with each of them."""

import numpy as np
import pytest
from numba import njit
from scipy.signal import butter, sosfilt, sosfilt_zi

from teleopdesign.measurement.eight_numbers import (
    EIGHT,
    add,
    put,
    scale,
    scale_and_add,
    subtract,
    take,
)
from teleopdesign.measurement.zero_phase import go_on, lanes, sections, zero_phase


@njit
def combine(x, y, factor, out):
    for at in range(0, len(x), EIGHT):
        u, v = take(x, at), take(y, at)
        w = subtract(add(u, v), scale(factor, u))
        put(scale_and_add(factor, w, v), out, at)


def test_sums_and_products_are_those_of_each_number():
    x, y = np.random.default_rng(1).normal(size=(2, 5 * EIGHT))
    out = np.zeros_like(x)
    combine(x, y, 0.7, out)
    # 1e-15: a product may be rounded with its sum
    assert out == pytest.approx(0.7 * (x + y - 0.7 * x) + y, abs=1e-15)


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("signals", [1, 2, 8, 16])
def test_signals_side_by_side_are_filtered_as_each_alone(signals, backward):
    y = np.random.default_rng(2).normal(size=(300, signals))
    sos, steady = sections(20.0, 1e-3)
    together, known = y.copy(), np.zeros((2, 2, signals))
    go_on(together, known, sos, backward)
    way = slice(None, None, -1) if backward else slice(None)
    alone, after = sosfilt(sos, y[way], axis=0, zi=np.zeros((2, 2, signals)))
    assert together == pytest.approx(alone[way], abs=1e-13)
    assert known == pytest.approx(after, abs=1e-13)


@pytest.mark.parametrize("signals", [3, 7, 8, 9, 17])
def test_columns_that_are_set_aside_change_no_signal(signals):
    y = np.random.default_rng(3).normal(size=(signals, 500))
    assert lanes(signals) % EIGHT == 0
    alone = [zero_phase(one, 20.0, 1e-3) for one in y]
    assert zero_phase(y, 20.0, 1e-3) == pytest.approx(np.array(alone), abs=1e-12)


@pytest.mark.parametrize("cutoff, sample_time", [(20.0, 1e-3), (5.0, 1e-3), (240.0, 2e-3)])
def test_the_low_pass_is_the_butterworth_filter_of_fourth_order(cutoff, sample_time):
    sos, steady = sections(cutoff, sample_time)
    theirs = butter(4, cutoff, fs=1 / sample_time, output="sos")
    y = 3.0 + np.random.default_rng(4).normal(size=2000)
    ours, _ = sosfilt(sos, y, zi=steady * y[0])
    expected, _ = sosfilt(theirs, y, zi=sosfilt_zi(theirs) * y[0])
    # poles at 0.97 of the unit circle lose 1e-13 to rounding
    assert ours == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("cutoff", [0.0, 500.0, 600.0, float("nan")])
def test_a_low_pass_beyond_half_the_sample_rate_is_refused(cutoff):
    with pytest.raises(ValueError, match="a low-pass at"):
        sections(cutoff, 1e-3)

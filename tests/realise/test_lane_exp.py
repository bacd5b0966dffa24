"""exp by plain arithmetic."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from teleopdesign.realise.lane_exp import exp


@njit(error_model="numpy")
def exponentials(x):
    out = np.empty_like(x)
    for i in range(len(x)):
        out[i] = exp(x[i])
    return out


@given(st.lists(st.floats(-706.0, 709.0), min_size=1, max_size=50))
def test_it_is_exp_to_two_units_in_the_last_place(x):
    expected = np.array([math.exp(a) for a in x])
    np.testing.assert_allclose(exponentials(np.array(x)), expected, rtol=2 * 2.3e-16)
    np.testing.assert_allclose([exp.py_func(a) for a in x], expected, rtol=2 * 2.3e-16)


@pytest.mark.parametrize(
    ("x", "expected"), [(0.0, 1.0), (-0.0, 1.0), (-800.0, 0.0), (-np.inf, 0.0), (np.inf, np.inf)]
)
def test_ends_are_exact(x, expected):
    assert exponentials(np.array([x]))[0] == expected


def test_what_is_no_number_stays_none():
    assert np.isnan(exponentials(np.array([np.nan]))[0])


def test_numbers_end_where_the_power_of_two_does():
    """Below the least normal number it is zero, and beyond the largest whole power infinite."""
    values = exponentials(np.array([-708.5, -708.0, 709.0, 709.3]))
    assert values[0] == 0.0 and values[3] == np.inf
    expected = [math.exp(-708.0), math.exp(709.0)]
    np.testing.assert_allclose(values[1:3], expected, rtol=1e-15)
    assert [exp.py_func(x) for x in (-708.5, 709.3)] == [0.0, np.inf]

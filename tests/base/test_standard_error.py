"""An estimate ends at the decimal where its standard error does."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.standard_error import with_standard_error


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (109.7, 21.3, "110 +- 21"),
        (0.02444, 0.00093, "0.02444 +- 0.00093"),
        (0.1972, 3e-4, "0.19720 +- 0.00030"),
        (263_100.0, 3100.0, "2.631e+05 +- 3.1e+03"),
        (-9e-3, 0.17, "-0.01 +- 0.17"),
        (5.0, 0.0996, "5.00 +- 0.10"),
        (2.0, math.nan, "2"),
        (2.0, math.inf, "2"),
        (2.5e-9, 1.3e-10, "2.50e-09 +- 1.3e-10"),
        (0.0, 1e-9, "0 +- 1e-09"),
    ],
)
def test_value_and_error_end_at_the_same_decimal(value, error, text):
    assert with_standard_error(value, error) == text


numbers = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e12, max_value=1e12)


@given(numbers, st.floats(min_value=1e-12, max_value=1e12))
def test_what_is_printed_is_within_a_tenth_of_the_error(value, error):
    """Seven digits are the most that a terminal shows of a value known better than that."""
    best, between, sure = with_standard_error(value, error).partition(" +- ")
    assert between and abs(float(best) - value) <= max(0.1 * error, 1e-6 * abs(value))
    assert float(sure) == pytest.approx(error, rel=0.051)

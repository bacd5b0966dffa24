"""Numbers with few digits are on the right side, and end where their standard errors do."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.sentences import round_down, round_near, round_up, with_standard_error

numbers = st.floats(
    allow_nan=False, allow_infinity=False, min_value=-1e200, max_value=1e200
).filter(lambda x: x == 0 or abs(x) > 1e-200)


@given(value=numbers, digits=st.integers(1, 8))
def test_a_number_is_held_between_its_two_roundings(value, digits):
    low, high = round_down(value, digits=digits), round_up(value, digits=digits)
    assert low <= value <= high
    assert high - low <= 1.001 * abs(value) * 10.0 ** (1 - digits)
    for one in (low, high):
        assert float(f"{one:.{digits}g}") == one


@given(value=numbers, digits=st.integers(1, 8))
def test_one_that_has_few_digits_stays(value, digits):
    few = round_near(value, digits=digits)
    assert round_down(few, digits=digits) == few == round_up(few, digits=digits)


@pytest.mark.parametrize("value", [0.0, math.inf, -math.inf])
def test_what_has_no_digits_stays(value):
    assert round_down(value) == value == round_up(value)


def test_a_hair_below_a_round_number_is_rounded_below_it():
    """A level of a hair less than 0.2 N is no level of 0.2 N."""
    assert round_down(0.2 * (1 - 1e-13), digits=4) == 0.1999
    assert round_up(0.2 * (1 + 1e-13), digits=4) == 0.2001


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


values = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e12, max_value=1e12)


@given(values, st.floats(min_value=1e-12, max_value=1e12))
def test_what_is_printed_is_within_a_tenth_of_the_error(value, error):
    """Seven digits are the most that a terminal shows of a value known better than that."""
    best, between, sure = with_standard_error(value, error).partition(" +- ")
    assert between and abs(float(best) - value) <= max(0.1 * error, 1e-6 * abs(value))
    assert float(sure) == pytest.approx(error, rel=0.051)

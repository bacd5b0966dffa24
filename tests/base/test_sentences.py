"""Numbers with few digits are on the right side, and end where their standard errors do."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.sentences import (
    number_on_page,
    percent,
    round_down,
    round_near,
    round_up,
    short_on_page,
    with_error_on_page,
    with_standard_error,
)

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


values = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e12, max_value=1e12)


@given(values, st.floats(min_value=1e-12, max_value=1e12))
def test_what_is_printed_is_within_a_tenth_of_the_error(value, error):
    """Seven digits are the most that a terminal shows of a value known better than that."""
    best, between, sure = with_standard_error(value, error).partition(" +- ")
    assert between and abs(float(best) - value) <= max(0.1 * error, 1e-6 * abs(value))
    assert float(sure) == pytest.approx(error, rel=0.051)


FINITE = st.floats(-1e12, 1e12).filter(lambda x: x == 0 or abs(x) > 1e-12)


def read(text):
    """The value of a printed number."""
    digits = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−", "0123456789--")
    head, _, power = text.partition("·10")
    return float(head.translate(digits)) * 10.0 ** int(power.translate(digits) or 0)


@given(FINITE, st.integers(2, 6))
def test_a_number_reads_back_to_its_digits(x, digits):
    # half a unit of the last digit kept, and rounding of the power of ten
    assert read(number_on_page(x, digits)) == pytest.approx(
        x, rel=0.51 * 10.0 ** (1 - digits), abs=0
    )
    assert read(short_on_page(x, digits)) == read(number_on_page(x, digits))


@given(FINITE, st.floats(1e-9, 1e6))
def test_a_value_and_its_error_are_printed_to_the_same_decimal(x, error):
    value, spread = with_error_on_page(x, error)
    assert read(spread) == pytest.approx(error, rel=0.06)  # two significant digits
    # a value with 7 digits or more is cut there
    assert read(value) == pytest.approx(x, rel=1e-6, abs=0.051 * 10 * error)


def test_a_part_that_is_no_number_is_unknown():
    assert percent(0.07071) == "7.07 %" and percent(0.5, ".0f") == "50 %"
    assert percent(0.999, ".2g") == "100 %" and percent(0.0123, ".2g") == "1.2 %"
    assert percent(math.nan) == "unknown" and percent(math.inf, unknown="not told") == "not told"

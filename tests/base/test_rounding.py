"""A number rounded down or up to few digits is never on the wrong side of the number."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.rounding import round_down, round_near, round_up

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

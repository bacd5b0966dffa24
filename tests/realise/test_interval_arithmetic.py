"""Sums, products and reciprocals lie between two floats next to each other."""

from fractions import Fraction
from math import inf, isfinite, nextafter

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from teleopdesign.realise.interval_arithmetic import (
    absolute,
    add_floats,
    multiply,
    multiply_floats,
    power,
    reciprocal,
)

LARGEST, SMALLEST = 1.7976931348623157e308, 5e-324
numbers = st.floats(allow_nan=False, allow_infinity=False)
near_one = st.floats(0.5, 2.0) | st.integers(-9, 9).map(float)
floats = numbers | near_one


def hold(ends, exact, apart=1):
    """The exact number lies between the ends, which are equal, or so many floats apart at most."""
    low, high = ends
    assert low == -inf or Fraction(low) <= exact
    assert high == inf or exact <= Fraction(high)
    for _ in range(apart):
        low = nextafter(low, inf) if low < high else low
    assert low >= high


@given(floats, floats)
@example(1.0, 2.0**-60)
@example(LARGEST, LARGEST)
@example(-LARGEST, -1e292)
@example(LARGEST, -LARGEST)
@example(SMALLEST, -1.0)
def test_a_sum_lies_between_the_floats_next_to_it(a, b):
    hold(add_floats(a, b), Fraction(a) + Fraction(b))
    if isfinite(a + b) and Fraction(a) + Fraction(b) == Fraction(a + b):
        assert add_floats(a, b) == (a + b, a + b)


@given(floats, floats)
@example(0.1, 3.0)
@example(SMALLEST, 0.5)
@example(-SMALLEST, SMALLEST)
@example(LARGEST, -2.0)
@example(1e-160, 1e-161)
@example(3e-119, 1e119)
def test_a_product_lies_between_the_floats_next_to_it(a, b):
    # beyond 1e120 and below 1e-120 one float more on either side
    hold(multiply_floats(a, b), Fraction(a) * Fraction(b), apart=2)


ends = st.sampled_from([0.0, inf, -inf, 1.0]) | st.floats(-1e9, 1e9)
intervals = (
    st.tuples(ends, ends).map(sorted).map(tuple).filter(lambda x: x[0] < inf and x[1] > -inf)
)


@given(intervals, intervals)
@example((0.0, 0.0), (-inf, inf))
@example((-2.0, 0.0), (0.0, 3.0))
@example((-2.0, 3.0), (-5.0, 0.1))
def test_a_product_of_intervals_reaches_from_the_least_to_the_largest_of_its_corners(x, y):
    corners = [multiply_floats(a, b) for a in x for b in y]
    expected = min(c[0] for c in corners), max(c[1] for c in corners)
    assert multiply(x, y) == expected == multiply(y, x)


@given(near_one, near_one)
def test_a_product_of_usual_size_is_rounded_once_and_is_itself_where_it_is_a_float(a, b):
    exact = Fraction(a) * Fraction(b)
    hold(multiply_floats(a, b), exact)
    if exact == Fraction(a * b):
        assert multiply_floats(a, b) == (a * b, a * b)


@given(floats.filter(bool))
@example(SMALLEST)
@example(-LARGEST)
@example(3.0)
def test_a_reciprocal_lies_between_the_floats_next_to_it(a):
    hold(reciprocal((a, a)), 1 / Fraction(a), apart=2)


ranges = st.tuples(numbers, numbers).map(sorted).map(tuple)
shares = st.fractions(0, 1)


def at(x, share):
    return Fraction(x[0]) + share * (Fraction(x[1]) - Fraction(x[0]))


@given(ranges, ranges, shares, shares, st.integers(1, 7))
def test_products_and_powers_of_intervals_hold_those_of_their_numbers(x, y, s, t, whole):
    low, high = multiply(x, y)
    assert low == -inf or Fraction(low) <= at(x, s) * at(y, t)
    assert high == inf or at(x, s) * at(y, t) <= Fraction(high)
    low, high = power(x, whole)
    assert low == -inf or Fraction(low) <= at(x, s) ** whole
    assert high == inf or at(x, s) ** whole <= Fraction(high)
    assert absolute(x)[0] <= abs(at(x, s)) <= absolute(x)[1]


@pytest.mark.parametrize(
    ("x", "y", "expected"),
    [
        ((0.0, 0.0), (-inf, inf), (0.0, 0.0)),
        ((0.0, 1.0), (0.0, inf), (0.0, inf)),
        ((-1.0, 2.0), (-inf, 3.0), (-inf, inf)),
        ((-3.0, -2.0), (2.0, 5.0), (-15.0, -4.0)),
    ],
)
def test_zero_times_an_unbounded_interval_is_zero(x, y, expected):
    assert multiply(x, y) == multiply(y, x) == expected

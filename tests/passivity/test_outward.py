"""Intervals that are rounded outward, against exact fractions and fifty digits of mpmath."""

import operator
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from teleopdesign.passivity.intervals import outward
from teleopdesign.passivity.intervals.outward import Outward, cosine_and_sine


def drawn(rng, n, decades=12):
    """Intervals of either sign, some without width, and a number within each."""
    at = rng.choice([-1.0, 1.0], n) * 10 ** rng.uniform(-decades, decades, n)
    width = np.abs(at) * 10 ** rng.uniform(-17, 1, n) * rng.integers(0, 2, n)
    low, high = at - width, at + width
    share = [Fraction(float(x)) for x in rng.random(n)]
    inside = [
        Fraction(a) + s * (Fraction(b) - Fraction(a))
        for a, b, s in zip(low, high, share, strict=True)
    ]
    return Outward(low, high), inside


def encloses(made, exact):
    ends = zip(made.low, made.high, exact, strict=True)
    return all(Fraction(a) <= x <= Fraction(b) for a, b, x in ends)


@pytest.mark.parametrize("operation", [operator.add, operator.sub, operator.mul])
def test_a_result_encloses_that_of_numbers_within(operation):
    rng = np.random.default_rng(1)
    (x, inside_x), (y, inside_y) = drawn(rng, 3000), drawn(rng, 3000)
    exact = [operation(a, b) for a, b in zip(inside_x, inside_y, strict=True)]
    assert encloses(operation(x, y), exact)


def test_products_below_and_beyond_the_range_of_floats_are_enclosed_or_show_nothing():
    tiny = Outward.exactly(np.array([1e-200, -3e-308, 5e-324]))
    product = tiny * tiny
    assert encloses(product, [Fraction(x) ** 2 for x in tiny.low])
    assert (product.smallest() == 0).all() and (product.largest() > 0).all()
    with np.errstate(all="ignore"):
        huge = Outward.exactly(np.array([1e200, -1e200])) * Outward.exactly(np.array([1e200]))
        assert np.isfinite(huge.smallest()).all() and np.isinf(huge.largest()).all()
        nothing = huge - huge
        assert not (nothing.smallest() > 0).any()


def test_sums_enclose_whatever_cancels_in_them():
    rng = np.random.default_rng(2)
    for n in (1, 2, 7, 300):
        made, inside = drawn(rng, n, decades=8)
        twice = Outward(np.r_[made.low, -made.high], np.r_[made.high, -made.low])
        total = twice.total()
        assert Fraction(float(total.low)) <= 0 <= Fraction(float(total.high))
        assert encloses(Outward(*(np.array([x]) for x in vars(made.total()).values())),
                        [sum(inside)])  # fmt: skip


def test_rational_numbers_are_enclosed_by_neighbours():
    numbers = [Fraction(1, 3), Fraction(-1, 10), Fraction(1, 2), Fraction(10) ** 400,
               -(Fraction(10) ** 400), Fraction(1, 10**400), Fraction(0)]  # fmt: skip
    made = Outward.about(numbers)
    for low, high, x in zip(made.low, made.high, numbers, strict=True):
        assert (np.isinf(low) or Fraction(low) <= x) and (np.isinf(high) or x <= Fraction(high))
    assert made.low[2] == made.high[2] == 0.5 and made.low[6] == made.high[6] == 0.0


@pytest.mark.parametrize("largest", [1e-8, 1.0, 1e3, 1e9, 1e18])
def test_sine_and_cosine_enclose_fifty_digits(largest):
    rng = np.random.default_rng(3)
    at = rng.uniform(-1, 1, 400) * largest
    at[:9] = np.arange(-4, 5) * np.pi / 4
    enclosure = cosine_and_sine(Outward.exactly(at))
    with mpmath.workdps(60):
        for made, function in zip(enclosure, (mpmath.cos, mpmath.sin), strict=True):
            for low, high, x in zip(made.low, made.high, at, strict=True):
                assert mpmath.mpf(low) <= function(mpmath.mpf(x)) <= mpmath.mpf(high)
    if largest <= 1e3:  # narrow, or nothing could be shown with them
        assert max(float((made.high - made.low).max()) for made in enclosure) < 4e-15 * max(
            largest, 1
        )


def test_sine_and_cosine_enclose_all_angles_within():
    rng = np.random.default_rng(4)
    low = rng.uniform(-20, 20, 500)
    high = low + 10 ** rng.uniform(-10, 1, 500)
    enclosure = cosine_and_sine(Outward(low, high))
    for share in np.linspace(0, 1, 21):
        for made, function in zip(enclosure, (np.cos, np.sin), strict=True):
            value = function(low + share * (high - low))
            assert (made.low <= value + 1e-15).all() and (value - 1e-15 <= made.high).all()


def test_a_quarter_turn_is_enclosed():
    with mpmath.workdps(40):
        quarter = outward._QUARTER
        assert mpmath.mpf(float(quarter.low)) < mpmath.pi / 2 < mpmath.mpf(float(quarter.high))


@pytest.mark.parametrize(
    ("low", "high"),
    [(-np.inf, np.inf), (0.0, np.inf), (np.nan, np.nan), (-1e300, 1e300), (1e25, 1e25), (0.0, 7.0)],
)
def test_of_an_angle_that_is_not_known_to_a_turn_nothing_is_shown(low, high):
    with np.errstate(all="ignore"):
        for made in cosine_and_sine(Outward(np.array([low]), np.array([high]))):
            assert made.low[0] == -1.0 and made.high[0] == 1.0

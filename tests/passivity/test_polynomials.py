"""Exact statements about polynomials, against their roots in floating point."""

import time
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.derive.polynomials import (
    X,
    is_hurwitz,
    is_non_negative,
    positive_roots,
    value,
    where_negative,
)
from teleopdesign.realise.lti import S

small = st.integers(-6, 6).map(lambda k: sp.Rational(k, 2))
positive = st.integers(1, 12).map(lambda k: sp.Rational(k, 4))


@settings(max_examples=60)
@given(st.lists(st.tuples(small, positive), min_size=1, max_size=4), st.sampled_from([1, -2]))
def test_hurwitz_is_that_of_the_roots(pairs, sign):
    """Products of (s + a)^2 + b^2, with a known by construction."""
    p = sp.Poly(sign * sp.prod([(S + a) ** 2 + b**2 for a, b in pairs]), S, domain="QQ")
    assert is_hurwitz(p) == all(a > 0 for a, _ in pairs)


@pytest.mark.slow
@settings(max_examples=60)
@given(st.lists(st.tuples(small, st.integers(1, 3)), min_size=1, max_size=4), st.booleans())
def test_sign_changes_are_detected_where_roots_are_odd(roots, negative):
    """Products of (x - r)^k: negative somewhere on x > 0 as counted by hand."""
    sign = -1 if negative else 1
    p = sp.Poly(sign * sp.prod([(X - r) ** k for r, k in roots]), X, domain="QQ")
    total = {r: sum(k for q, k in roots if q == r) for r, _ in roots}
    odd = [r for r, k in total.items() if k % 2 and r > 0]
    assert is_non_negative(p) == (not negative and not odd)
    below = where_negative(p)
    assert bool(below) == (not is_non_negative(p))
    assert all(x > 0 and value(p, x) < 0 for x in below)


@settings(max_examples=60)
@given(st.lists(small, min_size=1, max_size=5), positive)
def test_positive_roots_are_isolated_once_each(roots, b):
    p = sp.Poly(sp.prod([X - r for r in roots]) * (X**2 + b), X, domain="QQ")
    expected = sorted({float(r) for r in roots if r > 0})
    assert [float(x) for x in positive_roots(p)] == pytest.approx(expected, rel=1e-15)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.tuples(st.integers(-3, 12), st.integers(1, 9), st.integers(0, 2)), min_size=1, max_size=6
    ),
    st.integers(-12, 12),
)
def test_roots_are_isolated_quickly_over_twelve_decades(pairs, decade):
    """Roots m 10^k beside pairs that hardly miss the axis, as many as Sturm's chain counts."""
    parts = [X - m * sp.Rational(10) ** k for k, m, _ in pairs]
    parts += [(X - m) ** 2 + sp.Rational(10) ** -(k + 4) for k, m, near in pairs if near]
    p = sp.Poly(sp.prod(parts), X, domain="QQ").compose(
        sp.Poly(sp.Rational(10) ** decade * X, X, domain="QQ")
    )
    start = time.process_time()
    roots, below = positive_roots(p), where_negative(p)
    # s: 24 s for one polynomial of degree 18 before, 0.1 s now
    assert time.process_time() - start < 5
    assert len(roots) == p.sqf_part().count_roots(0) == len({m * 10.0**k for k, m, _ in pairs})
    assert all(value(p, x) < 0 for x in below)
    assert bool(below) == (not is_non_negative(p))


def test_roots_of_very_different_size_are_as_exact():
    roots = [Fraction(1, 10**15), Fraction(1, 3), Fraction(10**15)]
    p = sp.Poly(sp.prod([X - sp.Rational(str(r)) for r in roots]), X, domain="QQ")
    for enclosure, r in zip(positive_roots(p), roots, strict=True):
        assert abs(enclosure - r) <= r / 2**79


@pytest.mark.parametrize(
    ("coefficients", "holds"), [([0], False), ([3], True), ([-3], True), ([1, 0], False)]
)
def test_a_constant_has_no_root_and_zero_has_every_root(coefficients, holds):
    assert is_hurwitz(sp.Poly(coefficients, S, domain="QQ")) == holds

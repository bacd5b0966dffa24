"""Exact answers about lists of Fractions, against roots known by construction and against sympy."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.derive import polynomials as by_sympy
from teleopdesign.passivity.checker.polynomials import (
    add,
    derivative,
    divide,
    first_root,
    greatest_common_divisor,
    is_free_of_growth,
    is_hurwitz,
    is_non_negative,
    is_positive_real,
    multiply,
    polynomial,
    real_part,
    signs_at_roots,
    square_free,
    value,
)
from teleopdesign.passivity.checker.positive_roots import are_surely_coprime, has_positive_root
from teleopdesign.passivity.linear.impedance import impedance
from teleopdesign.passivity.linear.positive_real import (
    is_positive_real as is_positive_real_by_sympy,
)
from teleopdesign.passivity.two_port.growing_mode import sort_by_power

small = st.fractions(min_value=-4, max_value=4, max_denominator=3)
rows = st.lists(small, max_size=5).map(polynomial)
roots = st.lists(st.tuples(small, st.integers(1, 3)), min_size=1, max_size=4)
pairs = st.lists(st.tuples(small, st.sampled_from([0, 1, 2])), min_size=1, max_size=3)


def of_roots(given_roots, lead=1):
    """Product of (x - r)^k."""
    return multiply(
        [Fraction(lead)], *([-r, Fraction(1)] for r, k in given_roots for _ in range(k))
    )


def of_pairs(given_pairs):
    """Product of (s - a)^2 + b^2, or of s - a where b = 0."""
    factors = [
        [a * a + b * b, -2 * a, Fraction(1)] if b else [-a, Fraction(1)] for a, b in given_pairs
    ]
    return multiply(*map(polynomial, factors))


@given(rows, rows.filter(bool))
def test_quotient_and_remainder_make_up_the_whole(p, q):
    quotient, rest = divide(p, q)
    assert add(multiply(quotient, q), rest) == p
    assert len(rest) < len(q)


@pytest.mark.slow
@given(rows.filter(bool), rows.filter(bool), rows.filter(bool))
def test_what_two_products_share_divides_both(p, q, shared):
    common = greatest_common_divisor(multiply(p, shared), multiply(q, shared))
    assert divide(common, shared)[1] == []
    assert divide(multiply(p, shared), common)[1] == []


@given(roots, rows)
def test_signs_at_positive_roots_are_those_of_the_values(given_roots, f):
    """Each positive root once, whatever its multiplicity; f may vanish at some."""
    places = {r for r, _ in given_roots if r > 0}
    values = [value(f, r) for r in places]
    expected = tuple(sum(match(v) for v in values) for match in (_negative, _zero, _positive))
    assert signs_at_roots(f, of_roots(given_roots)) == expected


def _negative(v):
    return v < 0


def _zero(v):
    return v == 0


def _positive(v):
    return v > 0


def test_a_root_at_which_the_other_polynomial_vanishes_is_not_taken_for_the_next():
    """f = 2 - 2 x is 0 at the root 1 and negative at the root 2."""
    g = of_roots([(Fraction(1), 1), (Fraction(2), 1)])
    assert first_root([Fraction(2), Fraction(-2)], g) == pytest.approx(2.0, rel=1e-3)


@given(roots, rows)
def test_the_first_root_with_a_negative_value_is_located(given_roots, f):
    places = [r for r, _ in given_roots if r > 0 and value(f, r) < 0]
    root = first_root(f, of_roots(given_roots))
    if places:
        assert root == pytest.approx(float(min(places)), rel=1e-3)  # shown to four digits
    else:
        assert root != root


@given(roots, st.sampled_from([1, -2]))
def test_a_sign_changes_at_roots_of_odd_multiplicity(given_roots, lead):
    p = of_roots(given_roots, lead)
    x = sp.Poly([sp.Rational(c.numerator, c.denominator) for c in reversed(p)], by_sympy.X)
    assert is_non_negative(p) == by_sympy.is_non_negative(x)


@given(pairs)
def test_decay_and_growth_are_those_of_the_roots(given_pairs):
    """Hurwitz: all a < 0; free of growth: no a > 0, multiple and on the axis as well."""
    p = of_pairs(given_pairs)
    assert is_hurwitz(p) == all(a < 0 for a, _ in given_pairs)
    assert is_free_of_growth(p) == all(a <= 0 for a, _ in given_pairs)


@pytest.mark.slow
@settings(max_examples=60)
@given(rows, rows.filter(bool))
def test_positive_real_agrees_with_the_test_in_sympy(p, q):
    s = by_sympy.sp.Symbol("s")
    above, below = (
        sum(sp.Rational(c.numerator, c.denominator) * s**k for k, c in enumerate(r)) for r in (p, q)
    )
    z = impedance(above / below)
    assert is_positive_real(sort_by_power(z.p), sort_by_power(z.q)) == is_positive_real_by_sympy(z)


@given(rows, rows, small)
def test_the_real_part_on_the_axis_is_that_of_complex_numbers(p, q, w):
    def at(r):
        return sum(float(c) * (1j * float(w)) ** k for k, c in enumerate(r))

    product = at(p) * complex(at(q)).conjugate()
    # sums of at most 25 terms below 4^10
    assert float(value(real_part(p, q), w * w)) == pytest.approx(product.real, abs=1e-7)


@given(roots)
def test_a_square_free_polynomial_has_each_root_once(given_roots):
    plain = square_free(of_roots(given_roots))
    assert len(plain) - 1 == len({r for r, _ in given_roots})
    assert greatest_common_divisor(plain, derivative(plain)) == [1]


@pytest.mark.slow
@settings(max_examples=200)
@given(pairs, st.sampled_from([1, 3, 10**6, 10**-6]))
def test_a_positive_root_is_one_by_construction(given_pairs, scale):
    """Of simple roots over twelve decades: Descartes' rule with halved intervals."""
    unlike = {(a, b): (a * Fraction(scale), b * Fraction(scale)) for a, b in given_pairs if a or b}
    p = of_pairs(unlike.values())
    assert has_positive_root(p) == any(a > 0 and not b for a, b in unlike) if len(p) > 1 else True


@pytest.mark.slow
@given(rows.filter(lambda p: len(p) > 1), rows.filter(bool), rows.filter(bool))
def test_what_is_surely_coprime_shares_no_factor(common, p, q):
    assert not are_surely_coprime(multiply(common, p), multiply(common, q))
    if are_surely_coprime(p, q):
        assert sp.gcd(*(by_sympy_polynomial(x) for x in (p, q))).degree() == 0


def by_sympy_polynomial(p):
    return sp.Poly([sp.Rational(c) for c in reversed(p)], by_sympy.X, domain="QQ")

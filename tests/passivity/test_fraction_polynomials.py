"""What the checker decides of polynomials, against roots known by construction and the prover."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from passivity.small_certificates import sealed

from teleopdesign.passivity.checker import Refused, check
from teleopdesign.passivity.checker.over_a_box import SignsOverBox
from teleopdesign.passivity.checker.polynomials import (
    derivative,
    divide,
    greatest_common_divisor,
    is_hurwitz,
    polynomial,
    square_free,
)
from teleopdesign.passivity.linear.excess import is_positive_real
from teleopdesign.passivity.linear.impedance import impedance

LEFT = [10**12]
small = st.fractions(min_value=-4, max_value=4, max_denominator=3)
rows = st.lists(small, max_size=5).map(polynomial)
pairs = st.lists(st.tuples(small, st.sampled_from([0, 1, 2])), min_size=1, max_size=3)
X = sp.Symbol("s")


def written(p):
    return sum((sp.Rational(c.numerator, c.denominator) * X**k for k, c in enumerate(p)), sp.S(0))


def product(*factors):
    whole = sp.Poly(sp.Mul(*map(written, factors)), X)
    return polynomial(Fraction(int(c.p), int(c.q)) for c in reversed(whole.all_coeffs()))


def of_pairs(given_pairs):
    """Product of (s - a)^2 + b^2, or of s - a where b = 0."""
    factors = [
        [a * a + b * b, -2 * a, Fraction(1)] if b else [-a, Fraction(1)] for a, b in given_pairs
    ]
    return product(*map(polynomial, factors))


@pytest.mark.slow
@given(rows.filter(bool), rows.filter(bool), rows.filter(bool))
def test_what_two_products_share_divides_both(p, q, shared):
    common = greatest_common_divisor(product(p, shared), product(q, shared), LEFT)
    assert divide(common, shared, LEFT)[1] == []
    assert divide(product(p, shared), common, LEFT)[1] == []


@given(pairs)
def test_decay_and_growth_are_those_of_the_roots(given_pairs):
    """Hurwitz: all a < 0; free of growth: no a > 0, multiple and on the axis as well."""
    p = of_pairs(given_pairs)
    assert is_hurwitz(p, LEFT) == all(a < 0 for a, _ in given_pairs)
    signs = SignsOverBox({})
    as_terms = {(k,): c for k, c in enumerate(p) if c}
    assert signs.is_free_of_growth(as_terms) == all(a <= 0 for a, _ in given_pairs)


@given(pairs)
def test_a_square_free_polynomial_has_each_root_once(given_pairs):
    plain = square_free(of_pairs(given_pairs), LEFT)
    once = {(a, b) for a, b in given_pairs}
    assert len(plain) - 1 == sum(2 if b else 1 for _, b in once)
    assert greatest_common_divisor(plain, derivative(plain), LEFT) == [1]


@pytest.mark.slow
@settings(max_examples=60)
@given(rows, rows.filter(bool))
def test_a_certificate_is_accepted_where_the_prover_finds_it_positive_real(p, q):
    z = sp.cancel(written(p) / written(q))
    certificate = sealed({"kind": "positive real", "title": "", "impedance": [[str(z)]]})
    try:
        accepted = bool(check(certificate))
    except Refused:
        accepted = False
    assert accepted == is_positive_real(impedance(z))

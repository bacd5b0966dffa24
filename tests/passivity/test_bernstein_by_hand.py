"""Bernstein coefficients over boxes: values, halves and signs against plain evaluation."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.derive.polynomials import X
from teleopdesign.passivity.checker import Refused, box_signs
from teleopdesign.passivity.intervals import bernstein
from teleopdesign.passivity.intervals.bernstein import (
    ProofEffort,
    excludes_zero_over,
    is_non_negative_over,
)

Y, V = sp.symbols("y v")
SMALL = st.fractions(-4, 4, max_denominator=5)
SHARE = st.fractions(0, 1, max_denominator=7)


def value_of(b, shares):
    """The polynomial of these coefficients at shares of its axes, exactly."""
    for u in shares:
        d = len(b) - 1
        weights = [comb(d, i) * u**i * (1 - u) ** (d - i) for i in range(d + 1)]
        b = sum((w * row for w, row in zip(weights, b, strict=True)), 0 * b[0])
    return b[0]


@st.composite
def polynomials(draw):
    terms = draw(
        st.dictionaries(
            st.tuples(st.integers(0, 3), st.integers(0, 2), st.integers(0, 1)), SMALL,
            min_size=1, max_size=5,
        )
    )  # fmt: skip
    total = sp.Add(
        *(sp.Rational(c) * X**i * Y**j * V**k for (i, j, k), c in terms.items()), evaluate=True
    )
    return sp.Poly(total, X, Y, V, domain="QQ")


@settings(max_examples=8)
@given(
    polynomials(), SHARE, SHARE, SHARE, st.sampled_from([Fraction(1), Fraction(1, 3), Fraction(8)])
)
def test_coefficients_and_their_halves_have_the_values_of_the_polynomial(p, t, u, v, scale):
    """x = scale t/(1 - t), so that a number (1 - t)^d is in front; the box is not the unit one."""
    ends = [(Fraction(-1), Fraction(2)), (Fraction(1, 2), Fraction(1))]
    degrees = [d + 1 for d in p.degree_list()] if not p.is_zero else [1, 1, 1]
    b = bernstein._coefficients(p, degrees, ends, scale)
    assert b.shape == (*(d + 1 for d in degrees), 1)
    t = min(t, Fraction(6, 7))
    x, y, z = scale * t / (1 - t), -1 + 3 * u, Fraction(1, 2) + v / 2
    plain = p.as_expr().subs({X: sp.Rational(x), Y: sp.Rational(y), V: sp.Rational(z)})
    expected = Fraction(int(plain.p), int(plain.q)) * (1 - t) ** degrees[0]
    middle = value_of(b, (t, u, v))
    # integers by one common denominator: compared by a second point, or both are zero
    other = value_of(b, (Fraction(0), Fraction(0), Fraction(0)))
    plain = p.as_expr().subs({X: 0, Y: -1, V: sp.Rational(1, 2)})
    assert middle * Fraction(int(plain.p), int(plain.q)) == expected * other
    assert (middle > 0) == (expected > 0) and (middle < 0) == (expected < 0)
    for axis in range(3):
        halves = bernstein._halve(b, axis)
        shares = [t, u, v]
        half = int(shares[axis] >= Fraction(1, 2))
        shares[axis] = 2 * shares[axis] - half
        d = degrees[axis]
        assert value_of(halves[half], shares) == middle * 2**d
    corners = bernstein._corner_values(b)
    assert {*corners} == {value_of(b, (i, j, k)) for i in (0, 1) for j in (0, 1) for k in (0, 1)}


UNIT = [(Fraction(-1), Fraction(1)), (Fraction(0), Fraction(1))]


def poly(expression):
    return sp.Poly(expression, X, Y, V, domain="QQ")


@pytest.mark.parametrize("scale", [Fraction(1, 50), Fraction(5)])
@pytest.mark.parametrize(
    ("expression", "holds"),
    [
        (-((X - 2) ** 2) * (Y - 3), True),  # an even factor, and two signs that make one
        ((Y - 2) * (X + 1) * (V - 2), True),
        ((Y - 2) * (X + 1) * (V + 2), False),
        ((X**2 + 1) * (Y + sp.Rational(11, 10)), True),
        ((X**2 + 1) * (Y + sp.Rational(9, 10)), False),
        (X**2 - 2 * X * Y + 1, True),  # (x - y)^2 + 1 - y^2: zero at x = y = 1 alone
        (X**2 - sp.Rational(21, 10) * X * Y + 1, False),
        (sp.S(0) * X, True),
        (-sp.S(1) + 0 * X, False),
        (sp.S(2) + 0 * X, True),
    ],
)
def test_a_sign_over_all_of_x_and_a_box_is_shown_where_it_is_so(expression, holds, scale):
    effort = ProofEffort(left=8_000)
    is_non_negative = is_non_negative_over(poly(expression), UNIT, scale, effort)
    assert is_non_negative is holds or (holds and expression == X**2 - 2 * X * Y + 1)
    squares = [f.as_expr() for f in effort.squares]
    assert squares == ([X - 2] if (X - 2) ** 2 in sp.Mul.make_args(expression) else [])


@pytest.mark.parametrize(
    ("parts", "apart"),
    [
        ((X + 1,), True),
        ((X - 1,), False),
        ((Y + 2, 0 * X), True),
        ((0 * X, 0 * X), False),
        ((X - 1, X - 2), True),
        ((X - 1, Y - V), False),
        ((X * Y - 1, X + Y - 3), False),  # x = (3 + 5^(1/2))/2, y = (3 - 5^(1/2))/2
        ((X**2 - Y, X - V - 3), True),  # beyond 3 x^2 is above every y
        ((X - V, X + Y - 3), True),  # x within 0 to 1, and 2 to 4
        ((X - V, X + Y - 2), False),  # both at 1
    ],
)
def test_polynomials_are_apart_where_no_point_makes_all_of_them_zero(parts, apart):
    made = [poly(p) for p in parts]
    for scale in (Fraction(1), Fraction(7)):
        assert excludes_zero_over(made, UNIT, scale, ProofEffort(left=8_000)) is apart


def test_a_proof_ends_when_its_effort_is_spent_and_counts_what_it_looked_at():
    """Twelve coefficients: at an effort of eleven nothing is shown, at twelve it is."""
    p = poly((X + 1) * (Y + 2) ** 2 * V + X * Y * V + 5)
    size = np.prod([d + 1 for d in p.degree_list()])
    for left, shown in ((size, True), (size - 1, False)):
        effort = ProofEffort(left=int(left))
        assert is_non_negative_over(p, UNIT, Fraction(1), effort) is shown
        # the same is asked of -p, for a product may have its sign by two factors
        assert effort.cells == effort.polynomials == 2 and effort.left == left - 2 * size


def test_a_certificate_may_ask_for_so_many_coefficients_and_for_no_more(monkeypatch):
    """Of degrees 2 in x and 1 in v there are 3 times 2."""
    polynomial = dict.fromkeys(((2, 1), (2, 0), (0, 0)), Fraction(1))
    ends = [(Fraction(0), Fraction(1))]
    for most, allowed in ((6, True), (5, False)):
        monkeypatch.setattr(box_signs, "COEFFICIENTS", most)
        if allowed:
            assert box_signs.are_apart_from_zero([polynomial], ends, [10**9])
        else:
            with pytest.raises(Refused, match="more work"):
                box_signs.are_apart_from_zero([polynomial], ends, [10**9])

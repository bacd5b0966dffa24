"""Signs of polynomials for all x >= 0 and all values of a box: shown only where they hold."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from teleopdesign.passivity.checker import Refused, box_signs
from teleopdesign.passivity.linear.signs import Signs

X, Y, V = sp.symbols("x y v")
R = sp.Rational
RING = sp.ring((X, Y, V), sp.QQ)[0]
ENDS = [(Fraction(-1), Fraction(1)), (Fraction(0), Fraction(1))]


def poly(expression):
    return RING.from_expr(sp.expand(expression))


#: polynomial, and whether it is >= 0; "unshown": it is, and halving alone does not show it
SIGNS = [
    (X + Y + 2, True),
    (X**2 + Y**2, True),
    (X * (Y + 1), True),  # zero at an end of the interval
    ((X - 3) ** 2 * (Y + 1), True),  # a square is left out
    (-((X - 2) ** 2) * (Y - 3), True),  # an even factor, and two signs that make one
    ((Y - 2) * (X + 1) * (V - 2), True),
    ((Y - 2) * (X + 1) * (V + 2), False),
    ((X**2 + 1) * (Y + R(11, 10)), True),
    ((X**2 + 1) * (Y + R(9, 10)), False),
    (X**2 - X * Y + Y**2, "unshown"),  # zero at x = 0 alone, inside the interval of y
    (X**2 - 2 * X * Y + 1, "unshown"),  # (x - y)^2 + 1 - y^2: zero at x = y = 1 alone
    (X**2 - R(21, 10) * X * Y + 1, False),
    (X + Y, False),
    (X**2 - R(1, 10**6) * X, False),  # negative between 0 and 1e-6 alone
    (5 - X, False),  # negative beyond every bound of x
    (sp.S(0), True),
    (-sp.S(1), False),
    (sp.S(2), True),
]


@pytest.mark.parametrize("unit", [Fraction(1, 50), Fraction(5)])
@pytest.mark.parametrize(("expression", "holds"), SIGNS)
def test_a_sign_over_all_of_x_and_a_box_is_shown_where_it_holds(expression, holds, unit):
    shown = Signs(ENDS, left=20_000).is_non_negative(poly(expression), unit)
    assert shown is holds or holds == "unshown"


@pytest.mark.parametrize(
    ("p", "apart"),
    [
        ([1, 1, 1], True),
        ([Y, 1], False),
        ([2 + Y, 1], True),
        ([Y, 1, 1], False),  # a root that comes through zero
        ([Y + 2, 3, 2, 1], True),
        ([7, 3, 2, 1], False),
        ([R(3, 2) + Y, R(3, 2) + Y], True),
        ([R(1, 2) + Y, R(1, 2) + Y], False),  # at one value it is zero altogether
        ([(Y - R(123, 1000)) ** 2 - R(1, 10**8), 1, 1], False),  # a dip of the lowest coefficient
        ([49, (Y - R(1, 3)) ** 2, 1], False),  # touches the axis at one value inside
        ([49, (Y - R(1, 3)) ** 2 + R(1, 5), 1], True),
        ([10**6, (Y - R(1, 3)) ** 2, 1], False),
    ],
)
def test_a_polynomial_is_called_hurwitz_only_where_all_its_roots_decay(p, apart):
    """Coefficients of s from the lowest on."""
    whole = sum(c * X**k for k, c in enumerate(map(sp.sympify, p)))
    assert Signs(ENDS, left=60_000).is_hurwitz(poly(whole)) is apart


@pytest.mark.slow
def test_no_polynomial_with_a_small_dip_inside_is_called_non_negative():
    rng = np.random.default_rng(1)
    for _ in range(60):
        x0, y0 = (R(int(n), 97) for n in rng.integers(1, 90, 2))
        a, b = (R(int(n), 10) for n in rng.integers(-20, 20, 2))
        dip = R(1, 10 ** int(rng.integers(2, 12)))
        p = ((X - x0) + a * (Y - y0)) ** 2 + ((Y - y0) * (1 + X) + b * (X - x0)) ** 2 - dip
        unit = Fraction(2) ** int(rng.integers(-6, 6))
        assert not Signs(ENDS, left=2000).is_non_negative(poly(p), unit)


def test_a_proof_ends_when_its_effort_is_spent():
    """Twelve coefficients, of p and of -p: a product may have its sign by two factors."""
    p = poly((X + 1) * (Y + 2) ** 2 * V + X * Y * V + 5)
    size = int(np.prod([d + 1 for d in p.degrees()]))
    for left, shown in ((size, True), (size - 1, False)):
        signs = Signs(ENDS, left=left)
        assert signs.is_non_negative(p) is shown
        assert signs.cells <= 2 and signs.left >= -2 * size


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

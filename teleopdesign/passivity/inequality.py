"""A polynomial that is not negative for x >= 0, with a certificate.

P = g^2 x^e h with h > 0. Then (1 + x/c)^N h has no negative coefficient once N is large enough
(Polya), which shows the sign to anyone who can multiply polynomials.
"""

from __future__ import annotations

import sympy as sp

from ..errors import ModelError
from .certificate import Certificate, Term, storage_certificate
from .polynomials import is_non_negative

#: largest N tried; a polynomial that needs more has a root very close to the positive axis
LARGEST_POWER = 600


def inequality_certificate(title: str, polynomial: sp.Poly) -> Certificate | None:
    """That polynomial >= 0 for x >= 0; None where it is negative somewhere, or N is too large.

    The scale c is the geometric mean of the moduli of the roots of h.
    """
    x = sp.Symbol("x", real=True)
    poly = sp.Poly(polynomial.as_expr().subs(polynomial.gen, x), x, domain="QQ")
    if not is_non_negative(poly):
        return None
    square, rest = sp.Poly(1, x, domain="QQ"), poly
    if not poly.is_zero:
        _, factors = poly.sqf_list()
        for factor, k in factors:
            square *= factor ** (k // 2)
        rest = poly.quo(square**2)
    power = 0
    while not rest.is_zero and rest.eval(0) == 0:
        rest, power = rest.quo(sp.Poly(x, x)), power + 1
    found = _without_negative_coefficients(rest)
    if found is None:
        return None
    scale, n, coefficients = found
    terms: list[Term] = [
        (c, {"x": k + power, "unit": -n}, square.as_expr())
        for k, c in enumerate(coefficients)
        if c != 0
    ]
    certificate = storage_certificate(
        title,
        supply=poly.as_expr(),
        positive={"unit": 1 + x / scale},
        nonnegative={"x": x},
        proofs={"supply": {"": terms}, "storage": {"": ()}},
        example={"x": 1},
    )
    try:
        certificate.check()
    except ModelError:  # more work than the checker spends on one file
        return None
    return certificate


def _without_negative_coefficients(h: sp.Poly) -> tuple[sp.Rational, int, list[sp.Expr]] | None:
    """(c, N, rising coefficients of (1 + x/c)^N h), for the least N that is a power of two."""
    if h.is_zero or h.degree() == 0:
        return sp.Integer(1), 0, h.all_coeffs()
    ratio = float(abs(h.eval(0) / h.LC())) ** (1.0 / h.degree())
    scale = sp.Rational(2) ** round(float(sp.log(ratio, 2)))
    unit = sp.Poly(1 + h.gen / scale, h.gen, domain="QQ")
    n, product = 0, h
    while n <= LARGEST_POWER:
        rising = product.all_coeffs()[::-1]
        if min(rising) >= 0:
            return scale, n, rising
        step = max(1, n)
        product, n = product * unit**step, n + step
    return None

"""Exact tests and roots of real polynomials (sympy) with rational coefficients."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import gcd, lcm
from typing import Any

import numpy as np
import sympy as sp

#: the symbol x, the square of the angular frequency, omega^2
X = sp.Symbol("x")
#: the ring of exact polynomials in s
RING, *_ = sp.ring("s", sp.QQ)


def is_hurwitz(polynomial: sp.Poly) -> bool:
    """Whether every root has a negative real part (Routh's scheme); True for a constant not 0."""
    falling = [fraction(c) for c in polynomial.all_coeffs()]
    if falling[0] == 0:
        return False
    below = lcm(*(c.denominator for c in falling)) * (1 if falling[0] > 0 else -1)
    whole = [int(c * below) for c in falling]
    upper, lower = whole[::2], whole[1::2]
    for _ in whole[1:]:
        if not lower or lower[0] <= 0:
            return False
        padded = lower + [0] * (len(upper) - len(lower))
        # each row times a number > 0, by which no sign changes
        row = [lower[0] * u - upper[0] * v for u, v in zip(upper[1:], padded[1:], strict=True)]
        common = gcd(*row) or 1
        upper, lower = lower, [c // common for c in row]
    return True


def is_free_of_growth(polynomial: sp.Poly) -> bool:
    """Whether no root has a positive real part; roots on the axis are allowed.

    Roots on the axis are among those that the polynomial shares with its mirror image, r and -r.
    """
    plain = polynomial.sqf_part()
    shared = sp.gcd(plain, plain.compose(sp.Poly(-plain.gen, plain.gen)))
    if shared.degree() > 0:
        even, odd = (as_poly(half, X) for half in halves(element(shared)))
        on_axis = 2 * len(positive_roots(sp.gcd(even, odd))) + int(shared.eval(0) == 0)
        if on_axis < shared.degree():
            return False
    return is_hurwitz(plain.quo(shared))


def is_non_negative(polynomial: sp.Poly) -> bool:
    """Whether p(x) >= 0 for all x >= 0: no root of odd multiplicity at x > 0.

    Roots are isolated with continued fractions (Descartes). A Sturm chain would need seconds
    instead of milliseconds at degree 20.
    """
    if polynomial.is_zero:
        return True
    if polynomial.LC() < 0:
        return False
    for factor, multiplicity in polynomial.sqf_list()[1]:
        if multiplicity % 2 and has_positive_root(factor):
            return False
    return True


def has_positive_root(polynomial: sp.Poly) -> bool:
    """Whether a polynomial of simple roots has a root x > 0."""
    return any(high > 0 for _, high in _isolate(polynomial))


def where_negative(polynomial: sp.Poly) -> list[Fraction]:
    """Points x > 0 at which p(x) < 0, one in each gap between neighbouring roots with p < 0."""
    for bits in (20, 80, 1000):  # roots that agree in so many bits need more
        ends = [Fraction(0), *positive_roots(polynomial, bits=bits)]
        points = [(a + b) / 2 for a, b in zip(ends, ends[1:], strict=False)]
        points.append(2 * ends[-1] + 1)
        negative = [x for x in points if value(polynomial, x) < 0]
        if negative:
            return negative
    return []


def positive_roots(polynomial: sp.Poly, *, bits: int = 80) -> list[Fraction]:
    """Roots x > 0 of a polynomial, each once, by isolation and bisection.

    bits: the relative error is 2^-bits
    """
    if polynomial.degree() < 1:
        return []
    plain = polynomial.sqf_part()
    sign, slope = _sign_of(plain), _sign_of(plain.diff())

    def between(low: Fraction, high: Fraction) -> bool:
        """Whether the one root above `low` lies at or below `high`; simple roots only."""
        # at the neighbouring root, exactly: the sign just after it is that of the slope
        start, end = sign(low) or slope(low), sign(high)
        return end == 0 or start * end < 0

    roots = []
    for low, high in _isolate(plain):
        while low == 0 and high > 0:  # a relative error needs an end that is not 0
            middle = high / 2
            low, high = (low, middle) if between(low, middle) else (middle, high)
        while (high - low) * 2**bits > high:
            middle = (low + high) / 2
            low, high = (low, middle) if between(low, middle) else (middle, high)
        if high > 0:
            roots.append((low + high) / 2)
    return roots


def _isolate(polynomial: sp.Poly) -> list[tuple[Fraction, Fraction]]:
    """Ends of intervals that each contain one root x >= 0 of a polynomial of simple roots.

    With sympy's `fast`, x is scaled by its lower bound at each step. Without it, sympy reaches a
    root of 1e10 beside pairs of size 1 by small steps: 24 s at degree 18, not 2 ms. Both ways are
    exact.
    """
    ends = polynomial.intervals(inf=0, sqf=True, fast=True)
    return [(fraction(a), fraction(b)) for a, b in ends]


def _sign_of(polynomial: sp.Poly) -> Callable[[Fraction], int]:
    """A function: the sign of the polynomial at a rational point, computed in integers alone."""
    falling = [fraction(c) for c in polynomial.all_coeffs()]
    below = lcm(*(c.denominator for c in falling))
    whole = [int(c * below) for c in falling]

    def sign(at: Fraction) -> int:
        total, power = 0, 1
        for c in whole:
            total = total * at.numerator + c * power
            power *= at.denominator
        return (total > 0) - (total < 0)

    return sign


def value(polynomial: sp.Poly, at: Fraction) -> Fraction:
    """Exact value of a polynomial at a rational point."""
    total = Fraction(0)
    for c in polynomial.all_coeffs():
        total = total * at + fraction(c)
    return total


def fraction(number: sp.Expr) -> Fraction:
    """A sympy rational as a Fraction."""
    return Fraction(int(number.p), int(number.q))


def even_part(p: sp.Poly, q: sp.Poly) -> sp.Poly:
    """Re p(j w) conj q(j w) as a polynomial in x = w^2."""
    return as_poly(cross(element(p), element(q))[0], X)


def element(p: sp.Poly) -> Any:
    """A polynomial of one variable as an element of the ring of `halves`."""
    return RING({k: sp.QQ(int(c.p), int(c.q)) for k, c in p.terms() if c})


def as_poly(p: Any, variable: sp.Symbol) -> sp.Poly:
    """An element of a ring, of its first generator alone, as a polynomial in that variable."""
    return sp.Poly({k[:1]: c for k, c in p.items()} or {(0,): 0}, variable, domain="QQ")


def halves(p: Any) -> tuple[Any, Any]:
    """(a, b) with p(j w) = a(w^2) + j w b(w^2), in the ring of p; its first generator is s."""
    parts: tuple[dict[Any, Any], dict[Any, Any]] = ({}, {})
    for k, c in p.items():
        parts[k[0] % 2][(k[0] // 2, *k[1:])] = -c if k[0] // 2 % 2 else c
    return p.ring(parts[0]), p.ring(parts[1])


def cross(p: Any, q: Any) -> tuple[Any, Any]:
    """(a, b) with p(j w) conj q(j w) = a(w^2) + j w b(w^2), in the ring of `halves`."""
    (a, b), (c, d) = halves(p), halves(q)
    return a * c + p.ring.gens[0] * b * d, b * c - a * d


def roots_of(p: Any) -> np.ndarray:
    """Roots of an element of a ring, of its first generator alone, in floats, near their size."""
    top = max((k[0] for k in p), default=-1)
    most = max((abs(c) for c in p.values()), default=1)
    rising = np.zeros(top + 1)
    for k, c in p.items():
        share = c / most
        rising[k[0]] = float(Fraction(int(share.numerator), int(share.denominator)))
    return roots(rising[::-1])


def roots(falling: np.ndarray) -> np.ndarray:
    """Roots of a polynomial in floats, highest power first, computed near size 1, (n,)."""
    p = np.trim_zeros(np.asarray(falling, dtype=float), "f")
    kept = np.trim_zeros(p, "b")
    zeros = np.zeros(len(p) - len(kept), dtype=complex)
    if len(kept) < 2:
        return zeros
    scale = abs(kept[-1] / kept[0]) ** (1 / (len(kept) - 1))
    powers = scale ** -np.arange(len(kept), dtype=float)
    return np.concatenate([np.roots(kept * powers / kept[0]) * scale, zeros])

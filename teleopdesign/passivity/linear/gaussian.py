"""Exact complex numbers (two fractions), and exact values of rational functions."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt
from typing import Any

#: a complex number: real and imaginary part
Gaussian = tuple[Fraction, Fraction]

ZERO: Gaussian = (Fraction(0), Fraction(0))


def round_point(s: complex) -> Gaussian:
    """A point s as fractions, rounded to seven digits of its distance from the axis.

    Candidates of the search lie further apart than this rounding.
    """
    rate, frequency = Fraction(s.real), Fraction(s.imag)
    finer = len(str(int(abs(s) / s.real))) - 1
    return short(rate, 7), short(frequency, min(7 + finer, 17))


def short(x: Fraction, digits: int) -> Fraction:
    """x >= 0, rounded to so many significant digits."""
    if x == 0:
        return x
    place = digits - len(str(int(x))) if x >= 1 else digits + len(str(int(1 / x)))
    unit = Fraction(10) ** -place
    return round(x / unit) * unit


def square_root(x: Fraction, digits: int) -> Fraction:
    """A rational number near the square root of x; relative error below 10^-digits."""
    ten = 10**digits
    return Fraction(isqrt(x.numerator * x.denominator * ten**2), x.denominator * ten)


def value_at(p: Any, q: Any, at: Gaussian) -> Gaussian | None:
    """Exact value of p/q, polynomials in s, at a complex number; None at a pole."""
    above, below = (value(side, at) for side in (p, q))
    return None if below == ZERO else divide(above, below)


def value(p: Any, at: Gaussian) -> Gaussian:
    """Exact value of a polynomial, an element of a ring of s alone, at a complex number."""
    total, powers = ZERO, {k[0]: c for k, c in p.items()}
    for k in range(max(powers, default=-1), -1, -1):
        c = powers.get(k, 0)
        total = add(multiply(total, at), (Fraction(int(c.numerator), int(c.denominator)), ZERO[0]))
    return total


def add(a: Gaussian, b: Gaussian, factor: int = 1) -> Gaussian:
    """a + factor b."""
    return a[0] + factor * b[0], a[1] + factor * b[1]


def multiply(a: Gaussian, b: Gaussian) -> Gaussian:
    """a times b."""
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def divide(a: Gaussian, b: Gaussian) -> Gaussian:
    """a / b;  b: not zero."""
    size = b[0] ** 2 + b[1] ** 2
    return multiply(a, (b[0] / size, -b[1] / size))


def as_complex(a: Gaussian) -> complex:
    """The same number in floating point."""
    return complex(float(a[0]), float(a[1]))

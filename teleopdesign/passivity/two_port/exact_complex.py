"""Exact complex numbers (two fractions), and exact values of rational functions."""

from __future__ import annotations

from fractions import Fraction

from ..checker.absolute_stability import Ratio
from ..checker.polynomials import Polynomial

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


def value_at(one: Ratio, at: Gaussian) -> Gaussian | None:
    """Exact value of a rational function at a complex number; None at a pole."""
    p, q = (_horner(r, at) for r in one)
    return None if q == ZERO else divide(p, q)


def _horner(p: Polynomial, at: Gaussian) -> Gaussian:
    total = ZERO
    for c in reversed(p):
        total = add(multiply(total, at), (c, Fraction(0)))
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

"""Small matrices of polynomials over one denominator, N/d, and their closed loops with dampers.

Below: exact complex numbers, and exact values of rational functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from math import isqrt
from typing import Any

import numpy as np
import sympy as sp

from ...derive.effort import spend

Matrix = Sequence[Sequence[Any]]


def divide_out(n: Matrix, d: Any) -> tuple[Matrix, Any]:
    """N and d without the factors that all of them share."""
    shared = reduce(lambda a, b: a.gcd(b), (e for row in n for e in row), d)
    return [[e.exquo(shared) for e in row] for row in n], d.exquo(shared)


def hold(n: Matrix, d: Any, held: Sequence[Any]) -> list[list[Any]]:
    """Numerators of N/d + diag(held)."""
    return [
        [e + d * held[i] if i == j else e for j, e in enumerate(row)] for i, row in enumerate(n)
    ]


def close(n: Matrix, d: Any, held: Sequence[Any]) -> Any:
    """Denominator of (N/d + diag(held))^-1: its roots are the modes that the ports show."""
    return inverse_denominator(hold(n, d, held), d)


def inverse_denominator(rows: Matrix, below: Any) -> Any:
    """Denominator of the inverse of rows/below, coprime with it as a whole; 0: there is none."""
    whole, above = cofactors(rows, below)
    shared = reduce(lambda a, b: a.gcd(b), above, whole)
    return whole.exquo(shared) if whole else whole


def cofactors(rows: Matrix, below: Any) -> tuple[Any, list[Any]]:
    """Determinant of rows, and the entries of its inverse times this, times `below`."""
    size = range(len(rows))
    minors = [
        below
        * determinant([[rows[a][b] for b in size if b != j] for a in size if a != i], below.ring)
        for i in size
        for j in size
    ]
    return determinant(rows), minors


def determinant(rows: Matrix, ring: Any = None) -> Any:
    """Determinant of a small matrix of polynomials, along its first row."""
    if not rows:
        return ring.one
    total = rows[0][0].ring.zero
    for k, entry in enumerate(rows[0]):
        if entry:
            rest = [[*row[:k], *row[k + 1 :]] for row in rows[1:]]
            minor = determinant(rest, total.ring)
            spend(len(entry) * len(minor))
            total += (-1) ** k * entry * minor
    return total


def dampers(n: Matrix, d: Any) -> list[Any]:
    """A damper about as strong as each port of N/d: any numbers > 0 would be correct."""
    return [damper(row[k], d) for k, row in enumerate(n)]


def damper(n: Any, d: Any) -> Any:
    """A power of 2 near abs(n/d) where the powers of s have about one size."""
    unit = max(abs(c) for p in (n, d) for c in p.values())

    def sizes(p: Any) -> dict[int, float]:
        total: dict[int, float] = {}
        for powers, c in p.items():
            share = abs(c) / unit
            size = float(Fraction(share.numerator, share.denominator))
            total[powers[0]] = total.get(powers[0], 0.0) + size
        return total

    above, below = sizes(n), sizes(d)
    if not above:
        return sp.QQ(1)
    both = {k: above.get(k, 0.0) + below.get(k, 0.0) for k in {*above, *below}}
    low, high = min(both), max(both)
    rate = (both[low] / both[high]) ** (1 / (high - low)) if high > low else 1.0
    first, second = (sum(c * rate**k for k, c in side.items()) for side in (above, below))
    return rational(Fraction(2.0 ** round(np.log2(first / second))))


#: a complex number: real and imaginary part
Gaussian = tuple[Fraction, Fraction]


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


def rational(x: Fraction) -> Any:
    """The number as an element of sympy's domain of rationals, which computes."""
    return sp.QQ(x.numerator, x.denominator)


def exact_complex(at: Gaussian) -> Any:
    """The number as an element of sympy's domain of exact complex numbers, which computes."""
    return sp.QQ_I(*map(rational, at))


def parts_of(number: Any) -> Gaussian:
    """Real and imaginary part of an exact complex number."""
    re, im = (Fraction(int(x.numerator), int(x.denominator)) for x in (number.x, number.y))
    return re, im


def value_at(p: Any, q: Any, at: Gaussian) -> Any:
    """Exact complex value of p/q, polynomials in s, at a complex number; None at a pole."""
    above, below = (value(side, at) for side in (p, q))
    return above / below if below else None


def value(p: Any, at: Gaussian) -> Any:
    """Exact complex value of a polynomial, an element of a ring of s alone."""
    s, total, powers = exact_complex(at), sp.QQ_I.zero, {k[0]: c for k, c in p.items()}
    for k in range(max(powers, default=-1), -1, -1):
        total = total * s + powers.get(k, sp.QQ.zero)
    return total

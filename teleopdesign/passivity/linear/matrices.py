"""Small matrices of polynomials over one denominator, N/d, and their closed loops with dampers."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
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
    near = Fraction(2.0 ** round(np.log2(first / second)))
    return sp.QQ(near.numerator, near.denominator)

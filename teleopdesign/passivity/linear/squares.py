"""Quadratic forms as sums of squares, in exact numbers."""

from __future__ import annotations

from fractions import Fraction


def sum_of_squares(
    matrix: list[list[Fraction]],
) -> list[tuple[Fraction, list[Fraction]]] | None:
    """A quadratic form x^T M x as a sum of weight * (form . x)^2, in exact numbers.

    matrix: M, symmetric, (n, n)
    returns: (weight > 0, coefficients of the linear form, (n,)) for each square; None where M is
        not positive semidefinite
    """
    m = [list(row) for row in matrix]
    n = len(m)
    squares = []
    for k in range(n):
        pivot = m[k][k]
        if pivot < 0 or (pivot == 0 and any(m[k][j] for j in range(n))):
            return None
        if pivot == 0:
            continue
        form = [x / pivot for x in m[k]]
        squares.append((pivot, form))
        for i in range(n):
            factor = m[i][k]
            if factor:
                m[i] = [x - factor * f for x, f in zip(m[i], form, strict=True)]
    return squares

"""Sparse linear equations with polynomials as coefficients: determinant and solution, exactly."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from .effort import spend

#: an equation: unknown -> coefficient; the sum of coefficient times unknown is zero
Row = dict[str, Any]


def solve(
    rows: list[Row], wanted: Sequence[str], given: Sequence[str], ring: Any
) -> tuple[Any, list[list[Any]]]:
    """Determinant d of the unknowns, and N with wanted = N given/d, by elimination (Cramer).

    Unknowns that have a number as a coefficient go first; then Bareiss' scheme without fractions.
    """
    names = [n for n in dict.fromkeys(n for row in rows for n in row) if n not in given]
    if len(names) != len(rows) or not {*wanted} <= {*names}:
        return ring.zero, []
    scale, rows = eliminate_numbers([dict(row) for row in rows], {*wanted, *given})
    left = [n for n in dict.fromkeys(n for row in rows for n in row) if n not in {*wanted, *given}]
    columns = [*left, *wanted]
    if len(columns) != len(rows):
        return ring.zero, []
    matrix = [[row.get(n, ring.zero) for n in (*columns, *given)] for row in rows]
    determinant = _bareiss(matrix, len(columns), len(wanted), ring)
    if not determinant:
        return ring.zero, []
    answers = [[e * -scale for e in row[len(columns) :]] for row in matrix[len(left) :]]
    return determinant * scale, answers


def eliminate_numbers(rows: list[Row], kept: set[str]) -> tuple[Any, list[Row]]:
    """The rows without unknowns that have a number as a coefficient, and the product of these."""
    scale = sp.QQ(1)
    while True:
        uses: dict[str, int] = {}
        for row in rows:
            for n in row:
                uses[n] = uses.get(n, 0) + 1
        choices = [
            ((len(row) - 1) * (uses[n] - 1), i, n)
            for i, row in enumerate(rows)
            for n, c in row.items()
            if n not in kept and c.is_ground
        ]
        if not choices:
            return scale, rows
        _, i, name = min(choices)
        pivot = rows.pop(i)
        number = pivot.pop(name).LC
        scale *= number
        for row in rows:
            if name in row:
                factor = row.pop(name) * (-1 / number)
                for n, c in pivot.items():
                    total = row[n] + factor * c if n in row else factor * c
                    if total:
                        row[n] = total
                    else:
                        row.pop(n, None)


def _bareiss(matrix: list[list[Any]], size: int, last: int, ring: Any) -> Any:
    """Eliminate in place: the last rows become diagonal; returns the determinant but for its sign.

    size: number of unknowns, in the first columns;  last: number of rows at the end to make
        diagonal; further columns are transformed alike
    """
    before = ring.one
    for k in range(size):
        usable = [(len(matrix[i][k]), i) for i in range(k, size) if matrix[i][k]]
        if not usable:
            return ring.zero
        i = min(usable)[1]
        matrix[i], matrix[k] = matrix[k], matrix[i]
        pivot, pivots = matrix[k][k], matrix[k]
        for i in range(min(k + 1, size - last), size):
            row = matrix[i]
            if i == k:
                continue
            factor, row[k] = row[k], ring.zero
            for j in range(k + 1, len(row)):
                if row[j] or (factor and pivots[j]):
                    spend(len(pivot) * len(row[j]) + len(factor) * len(pivots[j]))
                    product = pivot * row[j] - factor * pivots[j]
                    row[j] = product if before == 1 else product.exquo(before)
            if i < k:
                row[i] = pivot
        before = pivot
    return before

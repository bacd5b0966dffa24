"""Certificates of kind "positive real": the matrix Z of rational functions of s is positive real.

The certificate contains Z alone, and the checker decides. Write Z = N/q. The proof has three steps.

1. (Z + 1)^-1 has a common denominator, and Routh's scheme shows that all its zeros have Re s < 0.
   So S = (Z - 1)/(Z + 1) = 1 - 2 (Z + 1)^-1 is analytic for Re s >= 0.
2. All principal minors of H = N conj(q) + N^H q = abs(q)^2 (Z + Z^H) are >= 0 on the imaginary
   axis. So H is positive semidefinite there, and so is
   1 - S^H S = 2 (Z + 1)^-H (Z + Z^H) (Z + 1)^-1.
3. By the maximum principle |S| <= 1 for Re s > 0. So Z is analytic for Re s > 0 with Z + Z^H >= 0.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

from .algebra import Quotient
from .effort import bound_effort, need
from .fields import expect_fields, read_matrix
from .polynomials import (
    Polynomial,
    add,
    coefficient_list,
    divide,
    greatest_common_divisor,
    halves,
    is_hurwitz,
    is_non_negative,
    multiply,
    polynomial,
    real_part,
)

#: numbers of rows that are allowed: each further row doubles the number of principal minors
SIZES = (1, 2, 3, 4, 5, 6)
Matrix = list[list[Polynomial]]


def state_positive_real(c: dict[str, Any]) -> str:
    """The statement that a certificate of this kind proves; raises Refused where Z is not so."""
    expect_fields(c, "kind", "title", "digest", "impedance")
    algebra, z, text = read_matrix(c["impedance"], SIZES)
    below = {n: max(e.below.get(n, 0) for row in z for e in row) for n in algebra.bases}
    q = coefficient_list(algebra.over(Quotient(algebra.number(1), {}), below, {}))
    above = [[coefficient_list(algebra.over(e, below, e.below)) for e in row] for row in z]
    with bound_effort(algebra.left):
        _check_stable(above, q)
        _check_resistive(above, q)
    return f"Z(s) = [{text}] is positive real: analytic with Z + Z^H >= 0 for Re s > 0"


def _check_stable(above: Matrix, q: Polynomial) -> None:
    """Raise Refused unless (Z + 1)^-1 = q adj(N + q)/det(N + q) is stable; Z = above/q."""
    size = len(above)
    m = [[add(e, q) if i == j else e for j, e in enumerate(row)] for i, row in enumerate(above)]
    every = range(size)
    common = d = minor(m, every, every)
    need(d, "Z + 1 is singular")
    for i, j in itertools.product(every, repeat=2):
        if len(common) < 2:
            break
        cofactor = minor(m, [k for k in every if k != i], [k for k in every if k != j])
        common = greatest_common_divisor(common, multiply(q, cofactor))
    need(is_hurwitz(divide(d, common)[0]), "not positive real: (Z - 1)/(Z + 1) is not stable")


def _check_resistive(above: Matrix, q: Polynomial) -> None:
    """Raise Refused unless all principal minors of Z + Z^H are >= 0 on the axis; Z = above/q."""
    size, q_late = len(above), _mirror(q)
    h = [
        [add(multiply(above[i][j], q_late), multiply(_mirror(above[j][i]), q)) for j in range(size)]
        for i in range(size)
    ]
    weight = real_part(q, q)
    for number in range(1, size + 1):
        for chosen in itertools.combinations(range(size), number):
            real, odd = halves(minor(h, chosen, chosen))
            need(not odd, "not positive real: odd on the axis")
            real = _divide_out(real, weight)
            need(is_non_negative(real), "not positive real: Re Z < 0 on the axis")


def _mirror(p: Polynomial) -> Polynomial:
    """p(-s), which is the conjugate of p(s) on the imaginary axis."""
    return [(-1) ** k * c for k, c in enumerate(p)]


def _divide_out(p: Polynomial, weight: Polynomial) -> Polynomial:
    """p divided by `weight` as often as it divides p; weight >= 0 on the axis, so signs remain."""
    while p and len(weight) > 1:
        quotient, rest = divide(p, weight)
        if rest:
            break
        p = quotient
    return p


def minor(matrix: Matrix, rows: Sequence[int], columns: Sequence[int]) -> Polynomial:
    """Determinant of the submatrix of these rows and columns, expanded along rows; 1 if empty."""
    known: dict[tuple[int, ...], Polynomial] = {(): polynomial([1])}
    for number in range(1, len(rows) + 1):
        row, smaller = matrix[rows[len(rows) - number]], known
        known = {}
        for chosen in itertools.combinations(columns, number):
            total: Polynomial = []
            for k, j in enumerate(chosen):
                rest = smaller[chosen[:k] + chosen[k + 1 :]]
                if row[j] and rest:
                    total = add(total, multiply(row[j], rest), (-1) ** k)
            known[chosen] = total
    return known[tuple(columns)]

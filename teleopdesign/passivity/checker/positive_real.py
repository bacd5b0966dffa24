"""Certificates of kind "positive real": a matrix of rational functions of s, decided from Z alone.

S = (Z - 1)/(Z + 1) has a common denominator with all zeros in Re s < 0 (Routh), and 1 - S(-s)^T
S(s) has principal minors >= 0 on the axis (Sturm): there, and by the maximum principle for Re s >
0, |S| <= 1. So Z is analytic for Re s > 0 with Z + Z^H >= 0.
"""

from __future__ import annotations

import itertools
from typing import Any

from .algebra import Poly, Quotient
from .effort import bounded, need
from .fields import expect_fields, read_matrix
from .polynomials import (
    Polynomial,
    add,
    divide,
    greatest_common_divisor,
    halves,
    is_hurwitz,
    is_non_negative,
    listed,
    multiply,
)


def state_positive_real(c: dict[str, Any]) -> str:
    """The statement of a certificate of this kind; refused where it is not true."""
    expect_fields(c, "kind", "title", "digest", "impedance")
    algebra, z, text = read_matrix(c["impedance"], (1, 2))
    plus, times, size = algebra.plus, algebra.times, len(z)
    below = {n: max(e.below.get(n, 0) for row in z for e in row) for n in algebra.bases}
    q = algebra.over(Quotient(algebra.number(1), {}), below, {})
    above = [[algebra.over(e, below, e.below) for e in row] for row in z]
    m, w = [[list(row) for row in above] for _ in "mw"]  # Z + 1 and Z - 1, times q
    for i in range(size):
        m[i][i], w[i][i] = plus(above[i][i], q), plus(above[i][i], q, -1)

    def cross(a: list[list[Poly]]) -> Poly:
        return plus(times(a[0][0], a[1][1]), times(a[0][1], a[1][0]), -1)

    d = m[0][0] if size == 1 else cross(m)
    need(d, "Z + 1 is singular")
    if size == 2:  # times the adjoint matrix
        adjoint = [[m[1][1], plus({}, m[0][1], -1)], [plus({}, m[1][0], -1), m[0][0]]]
        w = [[plus(times(w[i][0], adjoint[0][j]), times(w[i][1], adjoint[1][j])) for j in (0, 1)]
             for i in (0, 1)]  # fmt: skip
    with bounded(algebra.left):
        _check_bounded_real(listed(d), [[listed(e) for e in row] for row in w])
    return f"Z(s) = [{text}] is positive real: analytic with Z + Z^H >= 0 for Re s > 0"


def _check_bounded_real(d: Polynomial, w: list[list[Polynomial]]) -> None:
    """Refuse unless S = w/d is stable with 1 - S(-s)^T S(s) >= 0 on the axis."""
    common = d
    for e in itertools.chain(*w):
        common = greatest_common_divisor(common, e)
    d, w = divide(d, common)[0], [[divide(e, common)[0] for e in row] for row in w]
    need(is_hurwitz(d), "not positive real: (Z - 1)/(Z + 1) is not stable")
    size = len(w)

    def paired(a: Polynomial, b: Polynomial) -> Polynomial:
        return multiply([(-1) ** k * x for k, x in enumerate(a)], b)

    gap = [[paired(d, d) if i == j else [] for j in range(size)] for i in range(size)]
    for i, j, k in itertools.product(range(size), repeat=3):
        gap[i][j] = add(gap[i][j], paired(w[k][i], w[k][j]), -1)
    minors = [gap[i][i] for i in range(size)]
    if size == 2:
        minors.append(add(multiply(*minors), multiply(gap[0][1], gap[1][0]), -1))
    for minor in minors:
        real, odd = halves(minor)
        need(not odd, "not positive real: odd on the axis")
        need(is_non_negative(real), "not positive real: Re Z < 0 on the axis")

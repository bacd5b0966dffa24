"""Exact numbers for floats as they were written, and exact transfer functions from matrices.

A float stands for the shortest decimal number that prints like it; 0.1 is 1/10. Poles and zeros
that cancel on paper then cancel, and a pole at zero stays there.

So are transfer functions of laws with the values of a stage inserted.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix

if TYPE_CHECKING:
    from ._controller import Stage

_Numbers = Sequence[Sequence[float]] | np.ndarray


def exact_decimal(value: float) -> sp.Rational:
    """The decimal number that Python prints for a finite float: 0.1 gives 1/10."""
    return sp.Rational(repr(float(value)))


def make_exact(expression: sp.Expr) -> sp.Expr:
    """The expression with all numbers as fractions; pi and roots are rounded to a float first."""

    def is_inexact(part: sp.Basic) -> bool:
        return bool(part.is_number) and not part.is_rational and bool(part.is_extended_real)

    expression = sp.sympify(expression, strict=True)
    exact = {
        x: exact_decimal(x) for x in expression.atoms(sp.Float, sp.NumberSymbol) if x.is_finite
    }
    return expression.xreplace(exact).replace(is_inexact, lambda e: exact_decimal(sp.N(e)))


def resolvent(
    a: Sequence[Sequence[Fraction]], b: Sequence[Fraction], c: Sequence[Fraction]
) -> tuple[list[Fraction], list[Fraction]]:
    """Coefficients of det(s I - A) and of C adj(s I - A) B (Faddeev, Leverrier), highest first.

    a: (n, n), b: (n,), c: (n,);  returns: n + 1 and n coefficients
    """
    n = len(b)
    power = [[Fraction(i == j) for j in range(n)] for i in range(n)]
    below, above = [Fraction(1)], []
    for k in range(1, n + 1):
        above.append(
            sum((c[i] * power[i][j] * b[j] for i in range(n) for j in range(n)), Fraction(0))
        )
        moved = [
            [sum((a[i][m] * power[m][j] for m in range(n)), Fraction(0)) for j in range(n)]
            for i in range(n)
        ]
        coefficient = -sum((moved[i][i] for i in range(n)), Fraction(0)) / k
        below.append(coefficient)
        power = [[moved[i][j] + (i == j) * coefficient for j in range(n)] for i in range(n)]
    return below, above


def unseen_factor(a: _Numbers, b: _Numbers, c: _Numbers, variable: sp.Symbol) -> sp.Poly:
    """Factor of det(s I - A) of the modes that inputs and outputs together do not show.

    It is a factor of det(s I - A - B K C) for every K, and two of these share no other.

    a: (n, n), b: (n, inputs), c: (outputs, n);  variable: s, or z of a system in discrete time
    """
    n, inputs, outputs = len(a), len(b[0]), len(c)

    def exact(rows: _Numbers, shape: tuple[int, int]) -> DomainMatrix:
        numbers = [[exact_decimal(x) for x in row] for row in rows]
        return DomainMatrix.from_list_sympy(*shape, numbers, domain=sp.QQ)

    plain, of_inputs, of_outputs = exact(a, (n, n)), exact(b, (n, inputs)), exact(c, (outputs, n))
    sides = []
    for first in (1, 200):
        primes = [
            [sp.Rational(1, sp.prime(first + outputs * i + j)) for j in range(outputs)]
            for i in range(inputs)
        ]
        gains = DomainMatrix.from_list_sympy(inputs, outputs, primes, domain=sp.QQ)
        closed = plain + of_inputs * gains * of_outputs
        sides.append(sp.Poly(list(map(sp.QQ.to_sympy, closed.charpoly())), variable, domain="QQ"))
    return sp.gcd(*sides)


def has_numbers(stage: Stage) -> bool:
    """Whether the law is a measured response, or has a transfer function in z at a fixed period."""
    if stage.law.response is not None:
        return True
    return stage.law.in_z is not None and stage.values["period"] > 0


def is_by_numbers(stage: Stage) -> bool:
    """Whether the law states a transfer function or response, which depends on its input alone."""
    law = stage.law
    return any(x is not None for x in (law.transfer, law.in_z, law.response))


def insert_values(stage: Stage, s: sp.Symbol) -> sp.Expr:
    """Transfer function of a law that states one, with the values of the stage inserted."""
    if stage.law.transfer is not None:
        return stage.law.transfer(stage.values, s)
    if stage.law.response is not None:
        return exact_decimal(stage.values["scale"]) * stage.law.response(s)
    assert stage.law.in_z is not None
    period, z = exact_decimal(stage.values["period"]), sp.Symbol("z")
    late = sp.exp(-s * period)
    above, below = (
        sp.Poly(x, z) for x in sp.fraction(sp.together(stage.law.in_z(stage.values, z)))
    )
    # in powers of e^(-s T): those of e^(s T) overflow far out in the right half plane
    order = below.degree()
    sides = (
        sp.Add(*(c * late ** (order - k) for (k,), c in part.terms())) for part in (above, below)
    )
    return sp.Mul(next(sides), 1 / next(sides)) * (1 - late) / (s * period)

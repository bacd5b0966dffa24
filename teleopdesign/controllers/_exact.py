"""Exact numbers for floats as they were written, and exact transfer functions from matrices.

A float stands for the shortest decimal number that prints like it; 0.1 is 1/10. Poles and zeros
that cancel on paper then cancel, and a pole at zero stays there.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp


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

"""A matrix of transfer functions with the fewest states, exactly: common modes occur only once.

If each entry had separate states, each would have a copy of a mode that several entries share. A
second copy of a mode that decays or stays constant does no harm. Of a mode that grows, no loop can
stabilise more than one copy. The numbers are fractions: each column has the companion form of the
least common multiple of its denominators, and states that no output shows are removed (Kalman).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..controllers import exact_decimal

if TYPE_CHECKING:
    import control

_S = sp.Symbol("s")
Fractions = list[list[Fraction]]
Ratios = Sequence[Sequence[tuple[sp.Poly, sp.Poly]]]
#: relative distance from the axis or circle within which a pole counts as one that does not decay:
#: the pole is then shared, which is correct for any pole
_NEAR = 1e-9


def with_common_modes(
    system: control.TransferFunction, *, name: str
) -> control.TransferFunction | control.StateSpace:
    """The system as a state space if entries share a mode that does not decay; else unchanged.

    raises ModelError: a mode that grows is shared, and the matrices are no decimal numbers
    """
    from ..base import python_control as control

    ratios = [
        [_ratio(p, q) for p, q in zip(*row, strict=True)]
        for row in zip(system.num, system.den, strict=True)
    ]
    discrete = system.isdtime(strict=True)
    shared = _shared_poles([q for row in ratios for _, q in row])
    growth = np.abs(shared) - 1 if discrete else shared.real / np.maximum(np.abs(shared), 1.0)
    if not (growth >= -_NEAR).any():
        return system
    if any(p.degree() > q.degree() for row in ratios for p, q in row):
        return system  # improper: refused entry by entry
    matrices = _drop_unobserved(*_realise_columns(ratios))
    if len(matrices[0]) == sum(q.degree() for row in ratios for _, q in row):
        return system  # no state would be less
    if all(_is_decimal(x) for m in matrices for row in m for x in row):
        a, b, c, d = (np.array(m, dtype=float) for m in matrices)
        return control.ss(a, b, c, d, system.dt)
    if (growth > _NEAR).any():
        pole = shared[int(np.argmax(growth))]
        raise ModelError(
            f"{name}: entries share a mode that grows, at {pole:.4g}, and each would have a copy "
            "of it, which no loop stabilises: pass the system as a state space (control.ss)"
        )
    return system


def _ratio(above: Sequence[float], below: Sequence[float]) -> tuple[sp.Poly, sp.Poly]:
    """Coprime numerator and denominator; the denominator is monic."""
    p, q = (sp.Poly([exact_decimal(x) for x in side], _S, domain="QQ") for side in (above, below))
    p, q = p.cancel(q, include=True)
    return p.quo_ground(q.LC()), q.monic()


def _shared_poles(denominators: Sequence[sp.Poly]) -> np.ndarray:
    """Roots that at least two of the denominators share."""
    every = [
        sp.gcd(p, q) for k, p in enumerate(denominators) for q in denominators[k + 1 :]
    ]  # fmt: skip
    roots = [np.roots([float(c) for c in p.all_coeffs()]) for p in every if p.degree() > 0]
    return np.concatenate([np.empty(0, dtype=complex), *roots])


def _realise_columns(
    ratios: Sequence[Sequence[tuple[sp.Poly, sp.Poly]]],
) -> tuple[Fractions, Fractions, Fractions, Fractions]:
    """A, B, C, D: the companion form of each column's common denominator, one for each input."""
    columns = len(ratios[0])
    below = [reduce(sp.lcm, (row[j][1] for row in ratios)).monic() for j in range(columns)]
    starts = np.cumsum([0, *(q.degree() for q in below)])
    n = int(starts[-1])
    a, b = _zeros(n, n), _zeros(n, columns)
    c, d = _zeros(len(ratios), n), _zeros(len(ratios), columns)
    for j, q in enumerate(below):
        order, start = q.degree(), int(starts[j])
        for k in range(order):
            if k < order - 1:
                a[start + k][start + k + 1] = Fraction(1)
            else:
                b[start + k][j] = Fraction(1)
            a[start + order - 1][start + k] = -_coefficient(q, k)
        for i, row in enumerate(ratios):
            p = row[j][0] * q.quo(row[j][1])
            d[i][j] = _coefficient(p, order)
            rest = p - q * sp.Rational(d[i][j])
            for k in range(order):
                c[i][start + k] = _coefficient(rest, k)
    return a, b, c, d


def _drop_unobserved(
    a: Fractions, b: Fractions, c: Fractions, d: Fractions
) -> tuple[Fractions, Fractions, Fractions, Fractions]:
    """The system without states that no output shows, in the coordinates C, C A, C A^2 ..."""
    rows: Fractions = []
    pivots: list[int] = []
    waiting = [list(row) for row in c]
    while waiting:
        row = waiting.pop(0)
        image = _product([row], a)[0]
        for pivot, known in zip(pivots, rows, strict=True):
            row = _subtract(row, row[pivot], known)
        first = next((k for k, x in enumerate(row) if x), None)
        if first is None:
            continue
        row = [x / row[first] for x in row]
        rows = [_subtract(known, known[first], row) for known in rows]
        rows.append(row)
        pivots.append(first)
        waiting.append(image)
    moved = _product(rows, a)
    return (
        [[row[k] for k in pivots] for row in moved],
        _product(rows, b),
        [[row[k] for k in pivots] for row in c],
        d,
    )


def _subtract(row: list[Fraction], factor: Fraction, other: list[Fraction]) -> list[Fraction]:
    return [x - factor * y for x, y in zip(row, other, strict=True)] if factor else row


def _product(left: Fractions, right: Fractions) -> Fractions:
    columns = list(zip(*right, strict=True))
    return [[sum(map(Fraction.__mul__, row, k), Fraction(0)) for k in columns] for row in left]


def _zeros(rows: int, columns: int) -> Fractions:
    return [[Fraction(0)] * columns for _ in range(rows)]


def _coefficient(p: sp.Poly, power: int) -> Fraction:
    x = p.coeff_monomial(_S**power)
    return Fraction(int(x.p), int(x.q))


def _is_decimal(x: Fraction) -> bool:
    """Whether the float nearest to a fraction, read as decimal text, equals the fraction."""
    return bool(exact_decimal(float(x)) == sp.Rational(x.numerator, x.denominator))

"""Signs of polynomials over a box, by Bernstein coefficients in exact arithmetic.

Over [0, 1]^n a polynomial lies between the least and the greatest of its Bernstein coefficients,
and at corners it is the coefficient there. Where these bounds leave the sign open, the box is
halved (de Casteljau) and both halves are tested. The first variable runs over [0, inf]: x = c t/(1
- t), and the polynomial is multiplied by (1 - t)^d > 0. Coefficients are integers: each polynomial
is multiplied by the common denominator of its fractions, which is positive. Nothing is rounded.

Cargo, Shisha, J. Res. NBS 70B (1966) 79; Garloff, Interval Computations 2 (1993) 164.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product
from math import comb, lcm
from typing import Any, Literal

import numpy as np
import sympy as sp

from ...derive.polynomials import fraction

Ends = Sequence[tuple[Fraction, Fraction]]
#: most coefficients that all halvings may compute: some 5 s on one core. More would prove more
#: claims, in more time
MOST_WORK = 400_000
#: most coefficients of one polynomial: with more, a single halving takes seconds
MOST_COEFFICIENTS = 20_000


@dataclass
class ProofEffort:
    """Effort of the proofs of one claim.

    left: coefficients that may still be computed;  cells: parts of boxes that were tested
    polynomials: polynomials that were tested
    squares: factors, in x and the values, whose even powers were left out
    """

    left: int = MOST_WORK
    cells: int = 0
    polynomials: int = field(default=0)
    squares: list[sp.Poly] = field(default_factory=list)

    def spend(self, coefficients: int) -> bool:
        """Subtract the coefficients of one cell; returns whether the effort is sufficient."""
        self.cells += 1
        self.left -= coefficients
        return self.left >= 0


def is_non_negative_over(poly: sp.Poly, ends: Ends, scale: Fraction, effort: ProofEffort) -> bool:
    """Whether p(x, values) >= 0 is shown for all x >= 0 and all values in the box.

    Factors of even multiplicity are left out.

    poly: p in x and the values, rational coefficients;  ends: intervals of the values
    scale: x at t = 1/2, > 0;  effort: is spent
    returns: False where p is negative somewhere, or where nothing is shown
    """
    if poly.is_zero:
        return True
    number, factors = _factors(poly)
    sign = 1 if number > 0 else -1
    for factor, multiplicity in factors:
        if multiplicity > 1 and factor not in effort.squares:
            effort.squares.append(factor)
        if multiplicity % 2 == 0:
            continue
        ways = [s for s in (1, -1) if _holds((factor * s,), ends, scale, effort, _non_negative)]
        if not ways:
            return False
        sign *= ways[0]
    return sign > 0


def excludes_zero_over(
    parts: Sequence[sp.Poly], ends: Ends, scale: Fraction, effort: ProofEffort
) -> bool:
    """Whether it is shown that polynomials have no common zero for x >= 0 and values in the box.

    ends, scale, effort: as in `is_non_negative_over`
    """
    kept = [p for p in parts if not p.is_zero]
    return bool(kept) and _holds(kept, ends, scale, effort, _is_apart_from_zero)


def _factors(poly: sp.Poly) -> tuple[sp.Rational, list[tuple[sp.Poly, int]]]:
    """A number, and factors with their multiplicities; large polynomials are not factored."""
    if len(poly.terms()) > 600:  # beyond, factors take longer than the proof
        return sp.S(1), [(poly, 1)]
    number, factors = poly.factor_list()
    return number, [(f, m) for f, m in factors if f.total_degree() > 0]


Answer = Literal["yes", "no", "halve"]
Test = Callable[[list[Any]], Answer]


def _holds(
    polys: Sequence[sp.Poly], ends: Ends, scale: Fraction, effort: ProofEffort, test: Test
) -> bool:
    effort.polynomials += 1
    if any(np.prod([d + 1 for d in p.degree_list()]) > MOST_COEFFICIENTS for p in polys):
        return False
    degrees = [max(ds) for ds in zip(*(p.degree_list() for p in polys), strict=True)]
    cells = [[_coefficients(p, degrees, ends, scale) for p in polys]]
    while cells:
        cell = cells.pop()
        if not effort.spend(sum(b.size for b in cell)):
            return False
        answer = test(cell)
        if answer == "no":
            return False
        if answer == "halve":
            axis = _widest(cell)
            if axis is None:
                return False
            parts = [_halve(b, axis) for b in cell]
            cells += [[a for a, _ in parts], [b for _, b in parts]]
    return True


def _non_negative(cell: list[Any]) -> Answer:
    (b,) = cell
    if (b >= 0).all():
        return "yes"
    return "no" if min(_corner_values(b)) < 0 else "halve"


def _corner_values(b: Any) -> list[int]:
    """Values of the polynomial at all corners of the cell, which are coefficients."""
    return [b[at] for at in product(*((0, n - 1) for n in b.shape))]


def _is_apart_from_zero(cell: list[Any]) -> Answer:
    """Whether polynomials have no common zero in this cell.

    "yes" for two: the pairs of coefficients lie strictly on one side of a line through zero.
    """
    if any((b > 0).all() or (b < 0).all() for b in cell):
        return "yes"
    if all(b[(0,) * b.ndim] == 0 for b in cell):
        return "no"
    if len(cell) == 1:  # between corners of either sign it is zero somewhere
        at_corners = _corner_values(cell[0])
        return "halve" if min(at_corners) > 0 or max(at_corners) < 0 else "no"
    if len(cell) == 2:
        near = [_round_coefficients(b) for b in cell]
        u, v = (round(1024 * float(f.mean())) for f in near)
        if (u * near[0] + v * near[1]).min() > 0:
            sizes = [max(abs(x) for x in b.flat) for b in cell]
            if (u * sizes[1] * cell[0] + v * sizes[0] * cell[1] > 0).all():
                return "yes"
    return "halve"


def _round_coefficients(b: Any) -> np.ndarray:
    """Coefficients relative to the largest one, as floats: for choices, never for decisions."""
    size = max(abs(x) for x in b.flat)
    shift = max(0, int(size).bit_length() - 60)
    floats = (b >> shift).astype(float)
    return np.asarray(floats / max(float(int(size) >> shift), 1.0))


def _widest(cell: list[Any]) -> int | None:
    """The variable along which coefficients differ most, relative to each polynomial's size.

    None where all coefficients are equal.
    """
    spread = np.zeros(cell[0].ndim)
    for f in map(_round_coefficients, cell):
        for axis in range(f.ndim):
            if f.shape[axis] > 1:
                spread[axis] += np.abs(np.diff(f, axis=axis)).max() * (f.shape[axis] - 1)
    return int(spread.argmax()) if spread.any() else None


def _halve(b: Any, axis: int) -> tuple[Any, Any]:
    """Coefficients over both halves of the range of one variable, times 2^d > 0."""
    row = np.moveaxis(b, axis, 0)
    d = len(row) - 1
    left, right = [row[0] << d], [row[-1] << d]
    for k in range(1, d + 1):
        row = row[:-1] + row[1:]
        left.append(row[0] << (d - k))
        right.append(row[-1] << (d - k))
    ends = np.stack(left), np.stack(right[::-1])
    return np.moveaxis(ends[0], 0, axis), np.moveaxis(ends[1], 0, axis)


def _coefficients(poly: sp.Poly, degrees: Sequence[int], ends: Ends, scale: Fraction) -> Any:
    """Bernstein coefficients of these degrees, as integers, multiplied by a number > 0.

    returns: an array with an axis for each variable and one of length 1, so that numpy does not
        turn a single coefficient into a plain number
    """
    b = np.full([d + 1 for d in degrees], Fraction(0), dtype=object)
    for powers, c in poly.terms():
        b[powers] = fraction(c)
    d = degrees[0]
    ratios = np.array([scale**k / comb(d, k) for k in range(d + 1)], dtype=object)
    b = (b * ratios.reshape(-1, *[1] * (b.ndim - 1)))[..., None]
    for axis, (low, high) in enumerate(ends, start=1):
        b = np.moveaxis(_bernstein_coefficients(np.moveaxis(b, axis, 0), low, high), 0, axis)
    shared = lcm(*(x.denominator for x in b.flat))
    out = np.empty(b.shape, dtype=object)
    out[...] = np.frompyfunc(lambda x: int(x * shared), 1, 1)(b)
    return out


def _bernstein_coefficients(a: Any, low: Fraction, high: Fraction) -> Any:
    """Bernstein coefficients over a variable's range from its powers, along the first axis."""
    d, width = len(a) - 1, high - low
    shifted = [
        sum((comb(k, i) * low ** (k - i) * width**i * a[k] for k in range(i, d + 1)), 0 * a[0])
        for i in range(d + 1)
    ]
    rows = [
        sum((Fraction(comb(j, i), comb(d, i)) * shifted[i] for i in range(j + 1)), 0 * a[0])
        for j in range(d + 1)
    ]
    return np.stack(rows)

"""Signs of polynomials for all s on the axis, or all x >= 0, and all values within a box; exact.

At a point, a box without values, roots are isolated. Over a box Bernstein coefficients show signs:
over [0, 1]^n a polynomial lies between the least and the greatest of its coefficients, and at
corners it is the coefficient there. Where these bounds leave the sign open, the box is halved (de
Casteljau) and both halves are tested. The first variable runs over [0, inf]: x = c t/(1 - t), and
the polynomial is multiplied by (1 - t)^d > 0. Coefficients are integers, nothing is rounded.

Hurwitz: a polynomial is Hurwitz in the whole box if its leading coefficient is nowhere zero, if it
is Hurwitz at one point, and if it is nowhere zero on the axis, because roots move continuously.

Cargo, Shisha, J. Res. NBS 70B (1966) 79; Garloff, Interval Computations 2 (1993) 164.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product
from math import comb, lcm, prod
from typing import Any, Literal

import numpy as np
import sympy as sp

from ...derive.effort import spend
from ...derive.polynomials import X, as_poly, halves, is_hurwitz, is_non_negative
from ...realise.lti import S

Ends = Sequence[tuple[Fraction, Fraction]]
#: most coefficients that all halvings may compute: some 5 s on one core. More would prove more
#: claims, in more time
MOST_WORK = 400_000
#: most coefficients of one polynomial: with more, a single halving takes seconds
MOST_COEFFICIENTS = 20_000
#: terms of a polynomial of which factors are looked for
_MOST_TERMS = 600


@dataclass
class Signs:
    """Tests of polynomials in s (or x) and values, over one box; polynomials are ring elements.

    ends: intervals of the values, the generators of the ring after the first one
    left: coefficients that may still be computed;  cells: parts of boxes that were tested
    polynomials: polynomials that were tested
    squares: factors, in x and the values, whose even powers were left out
    """

    ends: Ends
    left: int = MOST_WORK
    cells: int = 0
    polynomials: int = 0
    squares: list[Any] = field(default_factory=list)

    def middle(self, p: Any) -> Any:
        """The polynomial at the middle of the box, a sympy polynomial in `S`."""
        middle = [sp.QQ(*((a + b) / 2).as_integer_ratio()) for a, b in self.ends]
        return as_poly(
            p.evaluate(list(zip(p.ring.gens[1:], middle, strict=True))) if middle else p, S
        )

    def is_hurwitz(self, p: Any) -> bool:
        """Whether it is shown that all roots in s are on the left, everywhere in the box."""
        if not p:
            return False
        middle = self.middle(p)
        if not is_hurwitz(middle):
            return False
        ends = (coefficient(p, degree(p)), coefficient(p, 0))
        if not self.ends or degree(p) == 0:
            return not self.ends or self.is_nonzero(ends[0])
        unit = axis_unit(middle)
        return all(map(self.is_nonzero, ends)) and self._excludes_zero(halves(p), unit)

    def is_nonzero(self, p: Any) -> bool:
        """Whether a polynomial in the values is shown to be zero nowhere in the box."""
        return self._excludes_zero((p,), Fraction(1))

    def is_non_negative(self, p: Any, unit: Fraction = Fraction(1)) -> bool:
        """Whether p(x, values) >= 0 is shown for all x >= 0, everywhere in the box.

        Factors of even multiplicity are left out.
        unit: scale of x, any number > 0
        """
        if not p:
            return True
        if not self.ends:
            self.polynomials += 1
            return is_non_negative(as_poly(p, X))
        # finding the factors of a large polynomial takes longer than the proof
        number, factors = p.factor_list() if len(p) <= _MOST_TERMS else (1, [(p, 1)])
        sign = 1 if number > 0 else -1
        for factor, multiplicity in factors:
            if factor.is_ground:
                continue
            if multiplicity > 1 and factor not in self.squares:
                self.squares.append(factor)
            if multiplicity % 2 == 0:
                continue
            ways = [s for s in (1, -1) if self._holds((factor * s,), unit, _non_negative)]
            if not ways:
                return False
            sign *= ways[0]
        return sign > 0

    def _excludes_zero(self, parts: Sequence[Any], unit: Fraction) -> bool:
        """Whether it is shown that polynomials have no common zero for x >= 0 and in the box."""
        kept = [p for p in parts if p]
        return bool(kept) and self._holds(kept, unit, _is_apart_from_zero)

    def _holds(self, polys: Sequence[Any], unit: Fraction, test: _Test) -> bool:
        self.polynomials += 1
        degrees = [max(ds) for ds in zip(*(p.degrees() for p in polys), strict=True)]
        size = prod(d + 1 for d in degrees)
        if size > MOST_COEFFICIENTS:
            return False
        spend(len(polys) * size * sum(d + 1 for d in degrees))
        cells = [[_coefficients(p, degrees, self.ends, unit) for p in polys]]
        while cells:
            cell = cells.pop()
            size = sum(b.size for b in cell)
            self.cells += 1
            self.left -= size
            spend(size)
            if self.left < 0:
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


def degree(p: Any) -> int:
    """The highest power of the first generator; -1 for zero."""
    return max((k[0] for k in p), default=-1)


def coefficient(p: Any, power: int) -> Any:
    """Coefficient of a power of the first generator, in the same ring."""
    return p.ring({(0, *k[1:]): c for k, c in p.items() if k[0] == power})


def axis_unit(p: sp.Poly) -> Fraction:
    """A power of 4 near the squared geometric mean of abs(roots): the x of the first halving."""
    powers = {k: Fraction(abs(c).p, abs(c).q) for (k,), c in p.terms()}
    low, high = min(powers), max(powers)
    if low == high:
        return Fraction(1)
    ratio = powers[low] / powers[high]
    bits = ratio.numerator.bit_length() - ratio.denominator.bit_length()
    unit: Fraction = Fraction(4) ** round(bits / (high - low))
    return unit


Answer = Literal["yes", "no", "halve"]
_Test = Callable[[list[Any]], Answer]


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


def _coefficients(p: Any, degrees: Sequence[int], ends: Ends, unit: Fraction) -> Any:
    """Bernstein coefficients of these degrees, as integers, multiplied by a number > 0.

    returns: an array with an axis for each variable and one of length 1, so that numpy does not
        turn a single coefficient into a plain number
    """
    b = np.full([d + 1 for d in degrees], Fraction(0), dtype=object)
    for powers, c in p.items():
        b[powers] = Fraction(c.numerator, c.denominator)
    d = degrees[0]
    ratios = np.array([unit**k / comb(d, k) for k in range(d + 1)], dtype=object)
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

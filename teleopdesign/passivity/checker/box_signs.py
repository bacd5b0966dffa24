"""Signs of polynomials for all x >= 0 and all values within a box, by Bernstein coefficients.

Over [0, 1]^n a polynomial lies between the least and the greatest of its Bernstein coefficients. At
each corner its value is the coefficient of this corner. If these bounds leave a sign open, the cell
is halved (de Casteljau) and both halves are tested. The variable x >= 0 is x = unit t/(1 - t), and
the polynomial is multiplied by (1 - t)^d > 0, so at t = 1 it is the highest coefficient.

Each polynomial is multiplied by a positive number that makes all coefficients integers, so nothing
is rounded. Floats choose only where to halve.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import comb, lcm, prod
from typing import Literal

from .algebra import Poly
from .effort import BITS, longest, need, spend_from

#: most coefficients of one polynomial: one cell with more of them takes seconds
COEFFICIENTS = 20_000
Ends = Sequence[tuple[Fraction, Fraction]]
Answer = Literal["yes", "no", "halve"]


@dataclass(frozen=True)
class BoxPart:
    """Bernstein coefficients of a polynomial over a part of the box; shape: along each variable.

    flat: all coefficients in one list; the index of the last variable runs fastest
    """

    shape: tuple[int, ...]
    flat: list[int]

    def corners(self) -> list[int]:
        """Values of the polynomial at all corners of this part."""
        values = []
        for at in product(*((0, n - 1) for n in self.shape)):
            place = 0
            for k, n in zip(at, self.shape, strict=True):
                place = place * n + k
            values.append(self.flat[place])
        return values

    def halved(self, axis: int) -> tuple[BoxPart, BoxPart]:
        """Coefficients over both halves of the range of one variable, times 2^d > 0."""
        left, right = list(self.flat), list(self.flat)
        d = self.shape[axis] - 1
        for line in _lines(self.shape, axis):
            row = [self.flat[i] for i in line]
            for k in range(d + 1):
                left[line[k]], right[line[d - k]] = row[0] << (d - k), row[-1] << (d - k)
                row = [a + b for a, b in zip(row, row[1:], strict=False)]
        return BoxPart(self.shape, left), BoxPart(self.shape, right)

    def spread(self, axis: int) -> float:
        """Largest change between neighbours, over the largest coefficient, times the degree."""
        size = max(map(abs, self.flat)) or 1
        lines = _lines(self.shape, axis)
        steps = (
            abs(self.flat[i] - self.flat[j]) for n in lines for i, j in zip(n, n[1:], strict=False)
        )
        return max(steps, default=0) / size * (self.shape[axis] - 1)


def are_non_negative(polys: Sequence[Poly], ends: Ends, left: list[int]) -> bool:
    """Whether each p(x, values) >= 0 is shown for all x >= 0 and all values in the box."""
    return all(_holds((p,), ends, left, _non_negative) for p in polys if p)


def are_apart_from_zero(polys: Sequence[Poly], ends: Ends, left: list[int]) -> bool:
    """Whether polynomials (one, or two) are shown to have no common zero for all x and values."""
    kept = [p for p in polys if p]
    return bool(kept) and _holds(kept, ends, left, _apart_from_zero)


def _holds(
    polys: Sequence[Poly], ends: Ends, left: list[int], test: Callable[[Sequence[BoxPart]], Answer]
) -> bool:
    count = len(ends) + 1
    degrees = [max(k[i] for p in polys for k in p) for i in range(count)]
    need(prod(d + 1 for d in degrees) <= COEFFICIENTS, "more work than a certificate may ask for")
    unit = _unit(polys)
    for p in polys:
        _spend_for_cell(p, degrees, [*ends, (unit, unit)], left)
    cells = [[_cell(p, degrees, ends, unit) for p in polys]]
    while cells:
        cell = cells.pop()
        bits = max(abs(b) for one in cell for b in one.flat).bit_length()
        spend_from(
            left, sum(len(one.flat) for one in cell) * (2 + max(degrees) // 2 + bits // 4096)
        )
        answer = test(cell)
        if answer == "no":
            return False
        if answer == "halve":
            axes = [i for i in range(count) if degrees[i]]
            if not axes:
                return False
            axis = max(axes, key=lambda i: sum(one.spread(i) for one in cell))
            halves = [one.halved(axis) for one in cell]
            cells += [[pair[side] for pair in halves] for side in (0, 1)]
    return True


def _spend_for_cell(p: Poly, degrees: Sequence[int], ends: Ends, left: list[int]) -> None:
    """Subtract the effort of making the first cell: sums over powers of the ends per variable."""
    highest = max(degrees)
    bits = longest(p.values()) + highest * (1 + longest(x for pair in ends for x in pair))
    need(bits <= BITS, "a number is too long")
    count = prod(d + 1 for d in degrees)
    spend_from(left, count * (highest + 1) * (1 + (bits * bits >> 17)))


def _non_negative(cell: Sequence[BoxPart]) -> Answer:
    (one,) = cell
    if min(one.flat) >= 0:
        return "yes"
    return "no" if min(one.corners()) < 0 else "halve"


def _apart_from_zero(cell: Sequence[BoxPart]) -> Answer:
    """No common zero: all pairs of coefficients lie strictly on one side of a line through 0."""
    if any(min(one.flat) > 0 or max(one.flat) < 0 for one in cell):
        return "yes"
    corners = list(zip(*(one.corners() for one in cell), strict=True))
    if any(not any(values) for values in corners):
        return "no"
    if len(cell) == 1:  # between corners of either sign it is zero somewhere
        signs = {values[0] > 0 for values in corners}
        return "no" if len(signs) == 2 else "halve"
    sizes = [max(map(abs, one.flat)) or 1 for one in cell]
    means = [sum(one.flat) / (len(one.flat) * size) for one, size in zip(cell, sizes, strict=True)]
    u, v = (round(1024 * mean) for mean in means)
    a, b = (one.flat for one in cell)
    above = (u * sizes[1] * x + v * sizes[0] * y > 0 for x, y in zip(a, b, strict=True))
    return "yes" if all(above) else "halve"


def _lines(shape: tuple[int, ...], axis: int) -> list[list[int]]:
    """Indices in the flat list along one variable, a list for each line of coefficients."""
    stride, n = prod(shape[axis + 1 :]), shape[axis]
    starts = (i for i in range(prod(shape)) if i // stride % n == 0)
    return [[start + k * stride for k in range(n)] for start in starts]


def _unit(polys: Sequence[Poly]) -> Fraction:
    """A power of 4 at which the powers of x have similar sizes; any unit > 0 would be correct."""
    sizes: dict[int, Fraction] = {}
    for p in polys:
        for k, c in p.items():
            sizes[k[0]] = sizes.get(k[0], Fraction(0)) + abs(c)
    low, high = min(sizes), max(sizes)
    if low == high:
        return Fraction(1)
    ratio = sizes[low] / sizes[high]
    bits = ratio.numerator.bit_length() - ratio.denominator.bit_length()
    power = round(bits / (2 * (high - low)))
    return Fraction(4) ** power


def _cell(p: Poly, degrees: Sequence[int], ends: Ends, unit: Fraction) -> BoxPart:
    """Bernstein coefficients over 0 <= t <= 1 and the whole box, as integers."""
    shape = tuple(d + 1 for d in degrees)
    flat = [Fraction(0)] * prod(shape)
    for powers, c in p.items():
        place = 0
        for k, n in zip(powers, shape, strict=True):
            place = place * n + k
        flat[place] = c * unit ** powers[0] / comb(degrees[0], powers[0])
    for axis, (low, high) in enumerate(ends, start=1):
        d = degrees[axis]
        for line in _lines(shape, axis):
            row = [flat[i] for i in line]
            shifted = [
                sum(comb(k, i) * low ** (k - i) * row[k] for k in range(i, d + 1))
                * (high - low) ** i
                for i in range(d + 1)
            ]
            for j in range(d + 1):
                terms = (Fraction(comb(j, i), comb(d, i)) * shifted[i] for i in range(j + 1))
                flat[line[j]] = sum(terms, Fraction(0))
    shared = lcm(*(c.denominator for c in flat))
    return BoxPart(shape, [(c * shared).numerator for c in flat])

"""Polynomials in s and names over a box, and certificates of kind "stable over a box".

A certificate over a box has the fields `box` (name -> [low, high], fractions, low < high) and
`squares` (polynomials P in x and the names; dividing a polynomial by P^2 does not change its sign).
Other fields hold polynomials in s and the names. A box without names is a point, where the checker
finds squares by itself.

"stable over a box": a polynomial p has no root with Re s >= 0, anywhere in the box. The checker
shows, with p(j w) = a(w^2) + j w b(w^2):

1. the highest coefficient and the constant coefficient are zero nowhere in the box;
2. a and b have no common zero with x = w^2 >= 0, anywhere in the box;
3. in the middle of the box all roots have Re s < 0 (Routh).

The box is connected and roots move continuously. By 1 no root comes from infinity, and by 1 and 2
no root meets the axis. So all roots stay on the left.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

from .algebra import Algebra, Poly, Quotient, expect, expect_fields, flat, read_number, read_words
from .box_signs import Ends, are_apart_from_zero, are_non_negative
from .effort import EFFORT, need
from .polynomials import (
    Polynomial,
    coefficient_list,
    derivative,
    divide,
    greatest_common_divisor,
    is_hurwitz,
    odd_part,
    square_free,
)

#: most names in a box: the effort grows with a power of their number
_MOST_VALUES = 8
PolyMatrix = list[list[Poly]]


class SignsOverBox:
    """Tests of signs of polynomials in s (or x) and the names over the box of a certificate.

    algebra: of s alone, for a certificate without a box
    """

    def __init__(self, c: dict[str, Any], algebra: Algebra | None = None) -> None:
        box = expect(dict, c.get("box", {}), "box")
        self.names = read_words(list(box), "box")
        fits = len(self.names) <= _MOST_VALUES and not {"s", "x"} & {*self.names}
        need(fits, "box: its names")
        self.ends: Ends = [_interval(box[n]) for n in self.names]
        self.algebra = algebra or Algebra(["s", *self.names], [EFFORT])
        axis = Algebra(["x", *self.names], self.left)
        squares = expect(list, c.get("squares", []), "squares")
        self.squares = [axis.read(text).above for text in squares]

    @property
    def left(self) -> list[int]:
        """Effort that is left, a list of one number."""
        return self.algebra.left

    def read(self, text: Any) -> Poly:
        """A polynomial in s and the names, from its text; raises Refused for another text."""
        return self.algebra.read(text).above

    def middle(self, p: Poly) -> Polynomial:
        """Coefficients of s of the polynomial in the middle of the box, lowest power first."""
        at = {n: (a + b) / 2 for n, (a, b) in zip(self.names, self.ends, strict=True)}
        powers: dict[tuple[int, ...], Poly] = {}
        for k, c in p.items():
            powers.setdefault((k[0],), {})[(0, *k[1:])] = c
        return coefficient_list({k: self.algebra.value(q, at) for k, q in powers.items()})

    def is_stable(self, p: Poly) -> bool:
        """Whether it is shown that no root of p has Re s >= 0, anywhere in the box."""
        if not p or not is_hurwitz(self.middle(p), self.left):
            return False
        if not self.names:
            return True
        ends = (coefficient(p, degree(p)), coefficient(p, 0))
        if not all(are_apart_from_zero((q,), self.ends, self.left) for q in ends):
            return False
        return degree(p) == 0 or are_apart_from_zero(halves(p), self.ends, self.left)

    def is_free_of_growth(self, p: Poly) -> bool:
        """Whether no root of p has Re s > 0, at a point.

        With each root counted once, this is so if and only if p'/p is positive real: p'/p is the
        sum of 1/(s - root), and on the axis the real part of such a term has the sign of -Re root.
        """
        plain = square_free(coefficient_list(p), self.left)
        both = plain, derivative(plain)
        polys: list[Poly] = [{(k,): c for k, c in enumerate(p) if c} for p in both]
        q, slope = polys
        if degree(q) == 0:
            return True
        stable = self.is_stable(self.algebra.plus(q, slope))
        return stable and self.are_non_negative([self.cross(slope, q)[0]], self.cross(q, q)[0])

    def is_nowhere_zero(self, p: Poly) -> bool:
        """Whether some coefficient of p is zero nowhere in the box, so that p is nowhere 0."""
        parts = (coefficient(p, k) for k in range(degree(p) + 1))
        return any(are_apart_from_zero((q,), self.ends, self.left) for q in parts)

    def are_non_negative(self, polys: Sequence[Poly], weight: Poly) -> bool:
        """Whether all are shown >= 0 for x >= 0 in the box; weight: a divisor that is >= 0."""
        return are_non_negative([self._short(p, weight) for p in polys], self.ends, self.left)

    def _short(self, p: Poly, weight: Poly) -> Poly:
        """The polynomial p divided by `weight` and by squares, as often as they divide p."""
        factors = [self.algebra.times(q, q) for q in self.squares]
        for factor in [*factors, weight]:
            while p and factor and max(map(sum, factor)) > 0:
                quotient, rest = self.algebra.divided(p, factor)
                if rest:
                    break
                p = quotient
        if self.names or not p:
            return p
        odd, sign = odd_part(coefficient_list(p), self.left), 1 if p[max(p)] > 0 else -1
        return {(k,): sign * c for k, c in enumerate(odd) if c}

    def cross(self, p: Poly, q: Poly) -> tuple[Poly, Poly]:
        """(a, b) in x = w^2 with p(j w) conj q(j w) = a + j w b."""
        (a, b), (c, d) = halves(p), halves(q)
        times, plus = self.algebra.times, self.algebra.plus
        return plus(times(a, c), times_x(times(b, d))), plus(times(b, c), times(a, d), -1)

    def minor(self, matrix: PolyMatrix, rows: Sequence[int], columns: Sequence[int]) -> Poly:
        """Determinant of the submatrix of these rows and columns; 1 if empty."""
        known: dict[tuple[int, ...], Poly] = {(): self.algebra.number(1)}
        for number in range(1, len(rows) + 1):
            row, smaller = matrix[rows[len(rows) - number]], known
            known = {}
            for chosen in combinations(columns, number):
                total: Poly = {}
                for k, j in enumerate(chosen):
                    rest = smaller[chosen[:k] + chosen[k + 1 :]]
                    if row[j] and rest:
                        total = self.algebra.plus(
                            total, self.algebra.times(row[j], rest), (-1) ** k
                        )
                known[chosen] = total
        return known[tuple(columns)]

    def reduce(self, above: Sequence[Poly], below: Poly) -> Poly:
        """`below` without factors that it shares with all of `above`; over a box powers of s."""
        if not self.names:
            whole = common = coefficient_list(below)
            for p in above:
                common = greatest_common_divisor(common, coefficient_list(p), self.left)
            whole = divide(whole, common, self.left)[0]
            return {(k,): c for k, c in enumerate(whole) if c}
        shared = min(k[0] for p in (below, *above) for k in p)
        return {(k[0] - shared, *k[1:]): c for k, c in below.items()}

    def inverse_denominator(self, m: PolyMatrix, d: Poly) -> Poly:
        """A polynomial of which all poles of the inverse of m/d are roots; {}: there is none."""
        every = range(len(m))
        det = self.minor(m, every, every)
        without = [[k for k in every if k != i] for i in every]
        cofactors = [self.minor(m, rows, columns) for rows in without for columns in without]
        if not det:
            return {}
        quotient, rest = self.algebra.divided(det, d) if degree(d) else (det, d)
        if not rest:
            return self.reduce(cofactors, quotient)
        return self.reduce([self.algebra.times(d, p) for p in cofactors], det)

    def has_passive_residues(self, n: PolyMatrix, d: Poly, *, symmetric: bool) -> bool:
        """Whether poles of N/d, of one port or two, are at s = 0 and infinity, and passive there.

        Shown are: d = r or d = s r, where all roots of r have Re s < 0; no entry grows faster than
        s; both residue matrices (coefficients of 1/s and of s) have k11, k22 >= 0 and
        k11 k22 >= k12 k21, and are symmetric where this is asked. r(0) and the highest coefficient
        of d have one sign in the whole box, by which N and d are multiplied.
        """
        has_zero = not coefficient(d, 0)
        rest = {(k[0] - 1, *k[1:]): c for k, c in d.items()} if has_zero else d
        if not self.is_stable(rest) or max(degree(e) for row in n for e in row) > degree(d) + 1:
            return False
        sign = 1 if self.middle(rest)[-1] > 0 else -1
        for power in (degree(d) + 1, *((0,) if has_zero else ())):
            k = [
                [{m: sign * c for m, c in coefficient(e, power).items()} for e in row] for row in n
            ]
            if symmetric and len(k) == 2 and self.algebra.plus(k[0][1], k[1][0], -1):
                return False
            every = range(len(k))
            tests = [*(k[i][i] for i in every), self.minor(k, every, every)]
            if not are_non_negative(tests, self.ends, self.left):
                return False
        return True

    def where(self) -> str:
        pairs = zip(self.names, self.ends, strict=True)
        listed = [f"{n} from {a} to {b}" for n, (a, b) in pairs]
        return f"for all {', '.join(listed)}" if listed else "no value left open"


def state_stability(c: dict[str, Any]) -> str:
    """The statement that a polynomial is stable over a box; raises Refused where not shown."""
    expect_fields(c, "kind", "title", "digest", "box", "squares", "polynomial")
    box = SignsOverBox(c)
    need(box.is_stable(box.read(c["polynomial"])), "not shown to be stable over the box")
    return f"no root of {flat(c['polynomial'])} has Re s >= 0, {box.where()}"


def read_impedance(
    c: dict[str, Any], sizes: Sequence[int], *more: str
) -> tuple[SignsOverBox, PolyMatrix, Poly, str, str]:
    """Z of a certificate: the box, numerators over one denominator, and its text.

    The last item says over which box, in words; "" for a matrix at a point.

    sizes: numbers of rows that are allowed, over a box two at most
    more: fields over a box besides those of every impedance
    """
    known = ("kind", "title", "digest")
    if c["kind"].endswith("over a box"):
        expect_fields(c, *known, "box", "squares", "numerators", "denominator", *more)
        rows = _read_square(c["numerators"], "numerators", [k for k in sizes if k < 3])
        box = SignsOverBox(c)
        n, d = [[box.read(e) for e in row] for row in rows], box.read(c["denominator"])
        need(d, "denominator: zero")
        need(box.is_nowhere_zero(d), "denominator: zero somewhere in the box")
        return box, n, d, f"{_text(rows)}/({flat(c['denominator'])})", f", {box.where()}"
    expect_fields(c, *known, "impedance")
    rows = _read_square(c["impedance"], "impedance", sizes)
    algebra = Algebra(["s"], [EFFORT], divides=True)
    z = [[algebra.read(e) for e in row] for row in rows]
    below = {b: max(e.below.get(b, 0) for row in z for e in row) for b in algebra.bases}
    n = [[algebra.over(e, below, e.below) for e in row] for row in z]
    d = algebra.over(Quotient(algebra.number(1), {}), below, {})
    return SignsOverBox({}, algebra), n, d, _text(rows), ""


def _read_square(value: Any, field: str, sizes: Sequence[int]) -> list[list[Any]]:
    """Rows of a square matrix of texts; raises Refused: another number of rows."""
    rows = [expect(list, row, field) for row in expect(list, value, field)]
    fits = len(rows) in sizes and all(len(row) == len(rows) for row in rows)
    need(fits, f"{field}: not {' or '.join(f'{k}x{k}' for k in sizes)}")
    return rows


def _text(rows: Sequence[Sequence[Any]]) -> str:
    """Z as its rows are written."""
    return "Z(s) = [" + ", ".join("[" + ", ".join(map(flat, row)) + "]" for row in rows) + "]"


def _interval(value: Any) -> tuple[Fraction, Fraction]:
    ends = expect(list, value, "box")
    need(len(ends) == 2, "box: expected [low, high]")
    low, high = (read_number(e, "box") for e in ends)
    need(low < high, "box: low is not below high")
    return low, high


def degree(p: Poly) -> int:
    """The highest power of s; 0 for zero."""
    return max((k[0] for k in p), default=0)


def coefficient(p: Poly, power: int) -> Poly:
    """Coefficient of that power of s, as a polynomial in the same names."""
    return {(0, *k[1:]): c for k, c in p.items() if k[0] == power}


def halves(p: Poly) -> tuple[Poly, Poly]:
    """(a, b) in x = w^2 with p(j w) = a + j w b."""
    parts: tuple[Poly, Poly] = ({}, {})
    for k, c in p.items():
        parts[k[0] % 2][(k[0] // 2, *k[1:])] = c * (-1) ** (k[0] // 2)
    return parts


def times_x(p: Poly) -> Poly:
    """x times a polynomial in x and the names."""
    return {(k[0] + 1, *k[1:]): c for k, c in p.items()}

"""Certificates over a box: a claim that holds for all values of some names within intervals.

Each certificate has the fields `box` (name -> [low, high], fractions, low < high) and `squares`
(polynomials P in x and the names; dividing a polynomial by P^2 does not change its sign). Other
fields hold polynomials in s and the names. The checker decides each kind from the fields alone.

"stable over a box": a polynomial p has no root with Re s >= 0, anywhere in the box. The checker
shows, with p(j w) = a(w^2) + j w b(w^2):

1. the highest coefficient and the constant coefficient are zero nowhere in the box;
2. a and b have no common zero with x = w^2 >= 0, anywhere in the box;
3. in the middle of the box all roots have Re s < 0 (Routh).

The box is connected and roots move continuously. By 1 no root comes from infinity, and by 1 and 2
no root meets the axis. So all roots stay on the left.

"positive real over a box", one port: Z = n/d, and some coefficient of d is nowhere zero. For a
scale c > 0, n + c d is stable over the box, and Re n conj(d) >= 0 on the axis. So (Z - c)/(Z + c) =
(n - c d)/(n + c d) is analytic for Re s >= 0, and on the axis its size is at most 1. This function
is bounded on the axis, so it is proper, and by the maximum principle its size is at most 1 for
Re s > 0. So Re Z >= 0 there.

"positive real over a box", two ports: Z = N/d with d = r or d = s r, r stable over the box, and no
numerator has a degree above that of d plus 1. So the poles on the axis lie at s = 0 and at
infinity and are simple. Their residues are n_ij(0)/r(0) and the coefficients of s at infinity. r(0)
and the highest coefficient of d have one sign in the whole box. N and d are multiplied by the sign
in the middle. The checker shows that both residue matrices are symmetric with k11, k22 and the
determinant >= 0, and that Z + Z^H is positive semidefinite on the axis. Z without its poles on the
axis is analytic and bounded for Re s >= 0, so v^H (Z + Z^H) v is harmonic there, and by the maximum
principle it is >= 0. The poles add a term >= 0.

"absolute stability over a box": the conditions of `absolute_stability.py` hold at each point of the
box. With L = z12 z21 the checker shows for the residues k11, k22 >= 0 and k11 k22 >= k12 k21, and
on the axis Re z11, Re z22 >= 0, A = 2 Re z11 Re z22 - Re L >= 0 and A^2 >= abs(L)^2. All these are
tested as polynomials, so they hold in the limit where d is zero, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from .algebra import Algebra, Poly
from .box_signs import Ends, are_apart_from_zero, are_non_negative
from .effort import EFFORT, need
from .fields import expect, expect_fields, flat, read_number, read_words
from .polynomials import coefficient_list, is_hurwitz

#: most names in a box: the effort grows with a power of their number
_MOST_VALUES = 8


class SignsOverBox:
    """Tests of signs of polynomials in s (or x) and the names over the box of a certificate."""

    def __init__(self, c: dict[str, Any]) -> None:
        box = expect(dict, c["box"], "box")
        names = read_words(list(box), "box")
        need(len(names) <= _MOST_VALUES and not {"s", "x"} & {*names}, "box: its names")
        self.ends: Ends = [_interval(box[n]) for n in names]
        self.algebra = Algebra(["s", *names], [EFFORT])
        axis = Algebra(["x", *names], self.algebra.left)
        squares = expect(list, c["squares"], "squares")
        self.squares = [axis.read(text).above for text in squares]
        self.names = names

    @property
    def left(self) -> list[int]:
        """Effort that is left, a list of one number."""
        return self.algebra.left

    def read(self, text: Any) -> Poly:
        """A polynomial in s and the names, from its text; raises Refused for another text."""
        return self.algebra.read(text).above

    def middle(self, p: Poly) -> list[Fraction]:
        """Coefficients of s of the polynomial in the middle of the box, lowest power first."""
        at = {n: (a + b) / 2 for n, (a, b) in zip(self.names, self.ends, strict=True)}
        powers: dict[tuple[int, ...], Poly] = {}
        for k, coefficient in p.items():
            powers.setdefault((k[0],), {})[(0, *k[1:])] = coefficient
        return coefficient_list({k: self.algebra.value(q, at) for k, q in powers.items()})

    def is_stable(self, p: Poly) -> bool:
        """Whether it is shown that no root of p has Re s >= 0, anywhere in the box."""
        n = _degree(p)
        if not p or not is_hurwitz(self.middle(p)):
            return False
        ends = (_coefficient(p, n), _coefficient(p, 0))
        if not all(are_apart_from_zero((q,), self.ends, self.left) for q in ends):
            return False
        return n == 0 or are_apart_from_zero(_halves(p), self.ends, self.left)

    def is_nowhere_zero(self, p: Poly) -> bool:
        """Whether some coefficient of p is zero nowhere in the box, so that p is nowhere 0."""
        parts = (_coefficient(p, k) for k in range(_degree(p) + 1))
        return any(are_apart_from_zero((q,), self.ends, self.left) for q in parts)

    def are_non_negative(self, polys: Sequence[Poly], weight: Poly | None = None) -> bool:
        """Whether all are shown >= 0 for x >= 0 in the box; weight: a divisor that is >= 0."""
        return are_non_negative([self._short(p, weight) for p in polys], self.ends, self.left)

    def _short(self, p: Poly, weight: Poly | None) -> Poly:
        """The polynomial p divided by `weight` and by squares, as often as they divide p."""
        factors = [self.algebra.times(q, q) for q in self.squares]
        for factor in [*factors, *([weight] if weight else [])]:
            while p and factor and max(map(sum, factor)) > 0:
                quotient, rest = self.algebra.divided(p, factor)
                if rest:
                    break
                p = quotient
        return p

    def cross(self, p: Poly, q: Poly) -> tuple[Poly, Poly]:
        """(a, b) in x = w^2 with p(j w) conj q(j w) = a + j w b."""
        (a, b), (c, d) = _halves(p), _halves(q)
        times, plus = self.algebra.times, self.algebra.plus
        return plus(times(a, c), _times_x(times(b, d))), plus(times(b, c), times(a, d), -1)

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


def state_positive_real(c: dict[str, Any]) -> str:
    """The statement that Z is positive real over a box; raises Refused where it is not shown."""
    box, n, d, text = _impedance(c)
    scale = read_number(c["scale"], "scale")
    need(scale > 0, "scale: not > 0")
    if len(n) == 1:
        both = box.algebra.plus(n[0], d, scale)
        shown = box.is_nowhere_zero(d) and box.is_stable(both)
        shown = shown and box.are_non_negative([box.cross(n[0], d)[0]])
    else:
        shown = _is_positive_real(box, n, d)
    need(shown, "not shown to be positive real over the box")
    return f"{text} is positive real: analytic with Z + Z^H >= 0 for Re s > 0, {box.where()}"


def state_absolute_stability(c: dict[str, Any]) -> str:
    """The statement that Z is absolutely stable over a box; raises Refused where not shown."""
    box, n, d, text = _impedance(c)
    need(len(n) == 4, "numerators: not 2x2")
    need(_is_absolutely_stable(box, n, d), "not shown to be absolutely stable over the box")
    return (
        f"{text} is absolutely stable: no positive-real Z1 and Z2 for which the inverse "
        f"(Z + diag(Z1, Z2))^-1 exists give it a pole with Re s > 0, {box.where()}"
    )


def _is_positive_real(box: SignsOverBox, n: list[Poly], d: Poly) -> bool:
    plus, times = box.algebra.plus, box.algebra.times
    known = _scale_signs(box, n, d)
    if known is None:
        return False
    n, d, residues = known
    if any(plus(k[1], k[2], -1) for k in residues):
        return False
    first, second = (box.cross(n[k], d)[0] for k in (0, 3))
    (a, b), (c, e) = box.cross(n[1], d), box.cross(n[2], d)
    # n12 conj d + conj(n21) d on the axis: conj turns the sign of what is odd
    even, odd = plus(a, c), plus(b, e, -1)
    size = plus(times(even, even), _times_x(times(odd, odd)))
    minor = plus(times(box.algebra.number(4), times(first, second)), size, -1)
    return _is_balanced(box, residues) and box.are_non_negative(
        [first, second, minor], box.cross(d, d)[0]
    )


def _is_absolutely_stable(box: SignsOverBox, n: list[Poly], d: Poly) -> bool:
    plus, times, number = box.algebra.plus, box.algebra.times, box.algebra.number
    known = _scale_signs(box, n, d)
    if known is None:
        return False
    n, d, residues = known
    first, second = (box.cross(n[k], d)[0] for k in (0, 3))
    real, odd = box.cross(times(n[1], n[2]), times(d, d))
    a = plus(times(number(2), times(first, second)), real, -1)
    size = plus(times(real, real), _times_x(times(odd, odd)))
    return _is_balanced(box, residues) and box.are_non_negative(
        [first, second, a, plus(times(a, a), size, -1)], box.cross(d, d)[0]
    )


def _is_balanced(box: SignsOverBox, residues: list[list[Poly]]) -> bool:
    """Whether all residue matrices are shown to have k11, k22 >= 0 and k11 k22 >= k12 k21."""
    plus, times = box.algebra.plus, box.algebra.times
    for k11, k12, k21, k22 in residues:
        minor = plus(times(k11, k22), times(k12, k21), -1)
        if not box.are_non_negative([k11, k22, minor]):
            return False
    return True


def _scale_signs(
    box: SignsOverBox, n: list[Poly], d: Poly
) -> tuple[list[Poly], Poly, list[list[Poly]]] | None:
    """N, d (highest coefficient > 0), and residues at infinity and at 0, times a number > 0.

    None where an entry grows faster than s, or where it is not shown that d has no zero with
    Re s >= 0 but a simple one at 0.
    """
    has_zero = not _coefficient(d, 0)
    rest = {(k[0] - 1, *k[1:]): c for k, c in d.items()} if has_zero else d
    if not box.is_stable(rest):
        return None
    if box.middle(rest)[-1] < 0:
        *n, d = ({k: -c for k, c in p.items()} for p in (*n, d))
    order = _degree(d)
    if any(_degree(p) > order + 1 for p in n):
        return None
    infinite = [_coefficient(p, order + 1) for p in n]
    return n, d, [infinite, *([[_coefficient(p, 0) for p in n]] if has_zero else [])]


def _impedance(c: dict[str, Any]) -> tuple[SignsOverBox, list[Poly], Poly, str]:
    """The box, the numerators row by row, the denominator, and the text of Z of a certificate."""
    fields = ("kind", "title", "digest", "box", "squares", "numerators", "denominator")
    expect_fields(c, *fields, *(["scale"] if c["kind"].startswith("positive") else []))
    rows = [expect(list, r, "numerators") for r in expect(list, c["numerators"], "numerators")]
    need(len(rows) in (1, 2) and all(len(r) == len(rows) for r in rows), "numerators: not 1x1, 2x2")
    box = SignsOverBox(c)
    n, d = [box.read(e) for row in rows for e in row], box.read(c["denominator"])
    need(d, "denominator: zero")
    above = ", ".join("[" + ", ".join(map(flat, row)) + "]" for row in rows)
    return box, n, d, f"Z(s) = [{above}]/({flat(c['denominator'])})"


def _interval(value: Any) -> tuple[Fraction, Fraction]:
    ends = expect(list, value, "box")
    need(len(ends) == 2, "box: expected [low, high]")
    low, high = (read_number(e, "box") for e in ends)
    need(low < high, "box: low is not below high")
    return low, high


def _degree(p: Poly) -> int:
    return max((k[0] for k in p), default=0)


def _coefficient(p: Poly, power: int) -> Poly:
    """Coefficient of that power of s, as a polynomial in the same names."""
    return {(0, *k[1:]): c for k, c in p.items() if k[0] == power}


def _halves(p: Poly) -> tuple[Poly, Poly]:
    """(a, b) in x = w^2 with p(j w) = a + j w b."""
    parts: tuple[Poly, Poly] = ({}, {})
    for k, c in p.items():
        parts[k[0] % 2][(k[0] // 2, *k[1:])] = c * (-1) ** (k[0] // 2)
    return parts


def _times_x(p: Poly) -> Poly:
    return {(k[0] + 1, *k[1:]): c for k, c in p.items()}

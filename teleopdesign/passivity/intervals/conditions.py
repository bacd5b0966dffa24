"""Claims about a family of linear systems as signs of polynomials over a box.

Hurwitz: a polynomial is Hurwitz in the whole box if its leading coefficient is nowhere zero, if it
is Hurwitz at one point, and if it is nowhere zero on the axis, because roots move continuously.
With p(j w) = a + j w b the last condition is: a at w = 0 is nowhere zero, and a and b have no
common zero.

Passive, one port: p/q is positive real if p + c q is Hurwitz for some c > 0, and Re p conj q >= 0
on the axis.

Passive, two ports: no pole lies in the right half plane, and none on the axis but at 0 and at
infinity. The residues there are symmetric and positive semidefinite, and the Hermitian part is
positive semidefinite on the axis.

Absolutely stable: the conditions of `checker/absolute_stability.py`, with the same poles. For two
ports, families with other poles on the axis are not proved.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
import sympy as sp

from ...derive.polynomials import X, is_hurwitz
from ...realise.lti import S
from .bernstein import Ends, ProofEffort, excludes_zero_over, is_non_negative_over
from .box import ValueBox


@dataclass
class Conditions:
    """Tests of polynomials in S and the symbols of values, over one box.

    symbols: of the values;  ends: their intervals;  effort: of the proofs
    """

    symbols: Sequence[sp.Symbol]
    ends: Ends
    effort: ProofEffort = field(default_factory=ProofEffort)

    @classmethod
    def over(cls, box: ValueBox, symbols: Mapping[str, sp.Symbol]) -> Conditions:
        """Tests over that box; symbols: name of a value -> its symbol."""
        return cls([symbols[n] for n in box.names], box.exact)

    def poly(self, expression: sp.Expr) -> sp.Poly:
        """The expression as a polynomial in S and the symbols.

        raises PolynomialError: the expression is no such polynomial
        """
        return sp.Poly(expression, S, *self.symbols, domain="QQ")

    def is_hurwitz(self, p: sp.Poly) -> bool:
        """Whether it is shown that all roots have a negative real part, everywhere in the box."""
        if p.is_zero or not self.nonzero(leading_coefficient(p)):
            return False
        if not is_hurwitz(self.middle(p)) or not self.nonzero(_coefficient(p, 0)):
            return False
        unit = scale(self.middle(p))
        return p.degree() == 0 or excludes_zero_over(halves(p), self.ends, unit, self.effort)

    def middle(self, p: sp.Poly) -> sp.Poly:
        """The polynomial in S at the middle of the box."""
        middle = [sp.Rational(str((a + b) / 2)) for a, b in self.ends]
        at_centre = p.as_expr().subs(dict(zip(self.symbols, middle, strict=True)))
        return sp.Poly(at_centre, S, domain="QQ")

    def nonzero(self, p: sp.Poly) -> bool:
        """Whether a polynomial in the symbols is shown to be zero nowhere in the box."""
        return excludes_zero_over((p,), self.ends, Fraction(1), self.effort)

    def non_negative(self, p: sp.Poly, unit: Fraction = Fraction(1)) -> bool:
        """Whether p(x, values) >= 0 is shown for all x >= 0, everywhere in the box.

        unit: scale of x, any number > 0
        """
        return is_non_negative_over(p, self.ends, unit, self.effort)


def one_port_is_passive(ask: Conditions, z: sp.Expr, *, margin: Fraction = Fraction(0)) -> bool:
    """Whether Z - margin is shown to be positive real everywhere in the box; margin: N s/m."""
    p, q = (ask.poly(e) for e in sp.fraction(sp.cancel(z - sp.Rational(str(margin)))))
    real = real_part(p, q)
    total = p + q * size_of(ask.middle(p), ask.middle(q))
    return ask.is_hurwitz(total) and ask.non_negative(real, scale(ask.middle(total)))


def two_port_is_passive(ask: Conditions, z: sp.Matrix, *, margin: Fraction = Fraction(0)) -> bool:
    """Whether Z - margin is shown to be positive real everywhere in the box; margin: N s/m."""
    common = _common(ask, z - sp.Rational(str(margin)) * sp.eye(2))
    if common is None:
        return False
    (n11, n12, n21, n22), d, residues = common
    if any(k[1] != k[2] for k in residues):
        return False
    e11, e22 = real_part(n11, d), real_part(n22, d)
    (a, b), (c, e) = cross(n12, d), cross(n21, d)
    # n12 conj d + conj(n21) d on the axis: conj turns the sign of what is odd
    even, odd = a + c, b - e
    x = sp.Poly(X, X, *ask.symbols, domain="QQ")
    twice = _divide_out(4 * e11 * e22 - even * even - x * odd * odd, real_part(d, d))
    return _are_all_non_negative(ask, (e11, e22, twice), residues, scale(ask.middle(d)))


def two_port_is_stable(ask: Conditions, z: sp.Matrix) -> bool:
    """Whether the two-port is shown to be absolutely stable everywhere in the box."""
    if two_port_is_passive(ask, z):
        return True
    common = _common(ask, z)
    if common is None:
        return False
    (n11, n12, n21, n22), d, residues = common
    e11, e22, size = real_part(n11, d), real_part(n22, d), real_part(d, d)
    re, im = cross(n12 * n21, d * d)
    x = sp.Poly(X, X, *ask.symbols, domain="QQ")
    llewellyn = _divide_out(2 * e11 * e22 - re, size)
    square = _divide_out(4 * e11 * e22 * (e11 * e22 - re) - x * im * im, size)
    return _are_all_non_negative(ask, (e11, e22, llewellyn, square), residues, scale(ask.middle(d)))


def _are_all_non_negative(
    ask: Conditions,
    polys: Sequence[sp.Poly],
    residues: Sequence[Sequence[sp.Poly]],
    unit: Fraction,
) -> bool:
    for k11, k12, k21, k22 in residues:
        if not all(ask.non_negative(p) for p in (k11, k22, k11 * k22 - k12 * k21)):
            return False
    return all(ask.non_negative(p, unit) for p in polys)


def _common(
    ask: Conditions, z: sp.Matrix
) -> tuple[list[sp.Poly], sp.Poly, list[list[sp.Poly]]] | None:
    """Numerators n_ij, one denominator d, and residues at infinity and 0, times numbers > 0.

    returns: None where it is not shown that d has no zero in the closed right half plane but a
        simple one at s = 0, or where an entry grows faster than s
    """
    parts = [tuple(map(ask.poly, sp.fraction(sp.cancel(e)))) for e in z]
    d = parts[0][1]
    for _, q in parts[1:]:
        d = sp.lcm(d, q)
    n = [p * sp.quo(d, q) for p, q in parts]
    s = ask.poly(S)
    rest, at_zero = sp.div(d, s)
    has_zero = bool(at_zero.is_zero)
    rest = rest if has_zero else d
    if not ask.is_hurwitz(rest):
        return None
    if ask.middle(rest).LC() < 0:
        n, d = [-one for one in n], -d
    if any(one.degree() > d.degree() + 1 for one in n):
        return None
    infinite = [_coefficient(one, d.degree() + 1) for one in n]
    zero = [_coefficient(one, 0) for one in n] if has_zero else []
    return n, d, [infinite, *([zero] if zero else [])]


def _divide_out(p: sp.Poly, size: sp.Poly) -> sp.Poly:
    """The polynomial divided by `size`, which is abs(d)^2 >= 0, as often as `size` divides it."""
    while size.degree() > 0 and not p.is_zero:
        quotient, rest = sp.div(p, size)
        if not rest.is_zero:
            break
        p = quotient
    return p


def leading_coefficient(p: sp.Poly) -> sp.Poly:
    """Coefficient of the highest power of s: a polynomial in the symbols (formally also in x)."""
    return _coefficient(p, p.degree())


def _coefficient(p: sp.Poly, power: int) -> sp.Poly:
    terms = {(0, *powers[1:]): c for powers, c in p.terms() if powers[0] == power}
    return sp.Poly(terms or {(0,) * len(p.gens): 0}, X, *p.gens[1:], domain="QQ")


def halves(p: sp.Poly) -> tuple[sp.Poly, sp.Poly]:
    """(a, b) in x = w^2 and the symbols with p(j w) = a + j w b."""
    parts: tuple[dict[tuple[int, ...], sp.Expr], ...] = ({}, {})
    for (k, *others), c in p.terms():
        parts[k % 2][(k // 2, *others)] = c * (-1) ** (k // 2)
    zero = {(0,) * len(p.gens): 0}
    gens = (X, *p.gens[1:])
    even, odd = (sp.Poly(part or zero, *gens, domain="QQ") for part in parts)
    return even, odd


def cross(p: sp.Poly, q: sp.Poly) -> tuple[sp.Poly, sp.Poly]:
    """(a, b) in x = w^2 and the symbols with p(j w) conj q(j w) = a + j w b."""
    (a, b), (c, d) = halves(p), halves(q)
    x = sp.Poly(X, *a.gens, domain="QQ")
    return a * c + x * b * d, b * c - a * d


def real_part(p: sp.Poly, q: sp.Poly) -> sp.Poly:
    """Re p(j w) conj q(j w) as a polynomial in x = w^2 and the symbols."""
    return cross(p, q)[0]


def size_of(p: sp.Poly, q: sp.Poly) -> sp.Rational:
    """A power of 2 near abs(p/q) on the axis, for the c > 0 of the proof; any c > 0 is correct.

    p, q: in S alone
    """
    w = float(scale(p + q)) ** 0.5
    above, below = (sum(abs(float(c)) * w**k for (k,), c in one.terms()) for one in (p, q))
    return sp.Rational(2) ** round(float(np.log2(above / below))) if above and below else sp.S(1)


def scale(p: sp.Poly) -> Fraction:
    """A power of 4 near the squared geometric mean of abs(roots): the x of the first halving.

    p: in S alone
    """
    powers = {k: abs(float(c)) for (k,), c in p.terms()}
    low, high = min(powers), max(powers)
    if low == high:
        return Fraction(1)
    power = round(float(np.log2(powers[low] / powers[high])) / (high - low))
    return Fraction(4**power) if power >= 0 else Fraction(1, 4**-power)

"""Impedances of one-ports as exact rational functions of s.

A float is read as the shortest decimal number that prints the same: 0.1 is 1/10. So a claim is
about exactly the written value, and a case on the boundary stays on the boundary. The number pi is
read as a float, with about sixteen digits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from typing import Any, Literal

import numpy as np
import sympy as sp

from ...base.arguments import describe_value
from ...base.errors import ModelError
from ...controllers import resolvent
from ...derive.linear_rows import read_late_ratios
from ...derive.polynomials import as_poly, element, fraction, is_hurwitz, roots_of
from ...realise.lti import S
from .matrices import parts_of, value_at

MotionKind = Literal["velocity", "position"]
_LONGEST = 9  # most characters of a fraction that a text contains as a fraction
_DIGITS = 60  # most digits of a decimal in a text
_SMALLEST = sp.Rational(1, 10**300)  # smallest size of a number that is also written as a float
#: highest degree in s: exact tests of numbers of 16 digits then take some 10 s, and the time grows
#: with the fourth power of the degree
_HIGHEST = 40
#: highest degree of an expression as it is written, of which factors may cancel
_UNCANCELLED = 10 * _HIGHEST
#: share of its size by which a root may lie on the left by rounding alone
_NEAR = 1e-9


@dataclass(frozen=True)
class Impedance:
    """Impedance of a one-port: force over velocity, p(s)/q(s), N s/m.

    p, q: coprime, rational coefficients, q monic; the degree of p may be above that of q
    unseen: modes of its python-control system that it does not show and that do not decay, 1/s
    """

    p: sp.Poly
    q: sp.Poly
    unseen: tuple[complex, ...] = ()

    @property
    def expression(self) -> sp.Expr:
        """p/q as a sympy expression in `realise.lti.S`."""
        return self.p.as_expr() / self.q.as_expr()

    def at(self, rate: Fraction, frequency: Fraction) -> tuple[Fraction, Fraction] | None:
        """Exact real and imaginary part at s = rate + j frequency (1/s); None at a pole."""
        value = value_at(element(self.p), element(self.q), (rate, frequency))
        return None if value is None else parts_of(value)

    def __call__(self, s: Any) -> Any:
        """Numerical value, N s/m, at complex s (array or number, 1/s)."""
        p, q = ([float(c) for c in poly.all_coeffs()] for poly in (self.p, self.q))
        return np.polyval(p, s) / np.polyval(q, s)

    def __str__(self) -> str:
        return readable(self.expression)

    def __reduce__(self) -> Any:
        # sympy pickles a polynomial without the domain of its coefficients
        return _restore, (self.p.as_expr(), self.q.as_expr(), self.unseen)


def _restore(above: sp.Expr, below: sp.Expr, unseen: tuple[complex, ...]) -> Impedance:
    p, q = (sp.Poly(e, S, domain="QQ") for e in (above, below))
    return Impedance(p, q, unseen)


def decimal(number: sp.Expr) -> str:
    """An exact number as the shortest text that reads back as it: a decimal, else a fraction.

    So two claims about different numbers never have the same words. Measured numbers in claims are
    rounded before (`identified.DIGITS`).
    """
    if number == 0 or _SMALLEST <= abs(number) <= 1 / _SMALLEST:
        for text in (f"{float(number):.12g}", repr(float(number))):
            if sp.Rational(text) == number:
                return text
    number = sp.Rational(number)
    with localcontext(Context(prec=_DIGITS)):  # a decimal of more digits than a float has
        text = f"{Decimal(number.p) / Decimal(number.q):f}"
    return text if sp.Rational(text) == number else str(number)


def readable(expression: sp.Expr) -> str:
    """An expression as text for people: exact; decimals where a fraction of it is long.

    The denominator of such an expression begins with the coefficient 1, as that of `Impedance`.
    """
    if any(_is_long(x) for x in expression.atoms(sp.Rational)):
        above, below = sp.fraction(expression)
        first = sp.expand(below).as_ordered_terms()[0].as_coeff_Mul()[0]
        expression = sp.expand(above / first) / sp.expand(below / first)
        numbers = {x for x in expression.atoms(sp.Rational) if _is_long(x) or not x.is_Integer}
        texts = {x: decimal(x) for x in numbers}
        decimals = {x: text for x, text in texts.items() if "/" not in text}
        digits = {x: sum(map(str.isdigit, t.partition("e")[0])) for x, t in decimals.items()}
        expression = expression.xreplace({x: sp.Float(t, digits[x]) for x, t in decimals.items()})
    return str(expression)


def _is_long(number: sp.Rational) -> bool:
    return len(str(number)) > _LONGEST


def impedance(system: Any, *, motion: MotionKind = "velocity") -> Impedance:
    """The impedance of a one-port as an exact rational function.

    system: sympy expression in s, number, python-control TransferFunction or StateSpace
        (continuous, one input, one output), or an Impedance
    motion: "velocity": `system` is force over velocity, N s/m; "position": `system` is force over
        position, N/m, as the blocks of a diagram are, and is divided by s
    raises ModelError: anything else, or a degree above 40
    """
    if motion not in ("velocity", "position"):
        raise ModelError(f'impedance: motion: expected "velocity" or "position", found "{motion}"')
    if isinstance(system, Impedance):
        made = system
    elif hasattr(system, "isdtime"):
        made = _from_control(system)
    else:
        e = read_expression(system, S, "impedance")
        _check_degree(max(_degrees(e)), _UNCANCELLED)
        (sides,), times = read_late_ratios([e], "impedance")
        if times:
            raise ModelError(f"impedance: not a rational function of s: {e}")
        made = impedance_of(*sides)
        _check_degree(max(made.p.degree(), made.q.degree()))
    if motion == "position":
        over_position = impedance_of(element(made.p), element(made.q * sp.Poly(S, S)))
        return replace(over_position, unseen=made.unseen)
    return made


def exact(number: Any, where: str = "") -> sp.Rational:
    """A number, or its text, as an exact rational; a float as its shortest decimal.

    where: beginning of the message, such as "z_width: damping: "
    raises ModelError: no finite real number, or a truth value
    """
    if isinstance(number, sp.Expr) and number.is_Rational:
        return number
    try:
        if isinstance(number, bool | bytes):
            raise TypeError("no number")
        if isinstance(number, int | Fraction | np.integer):
            return sp.Rational(number)
        value = float(number)
        return sp.Rational(repr(value))
    except (TypeError, ValueError, OverflowError):
        text = describe_value(number)
        raise ModelError(f"{where}expected a finite real number, found {text}") from None


def read_expression(system: Any, symbol: sp.Symbol, where: str) -> sp.Expr:
    """An expression of one symbol, which is known by its name, with exact numbers.

    where: beginning of the message
    raises ModelError: no expression (a text, which would be run), another symbol, or infinity
    """
    try:
        e = sp.sympify(system, strict=True)
    except (sp.SympifyError, TypeError, AttributeError):
        e = None
    if not isinstance(e, sp.Expr) or e.is_Matrix:
        wrong = describe_value(system)
        raise ModelError(f"{where}: expected an expression in {symbol}, found {wrong}")
    e = e.xreplace({x: symbol for x in e.free_symbols if x.name == symbol.name})
    if others := {x.name for x in e.free_symbols - {symbol}}:
        raise ModelError(f"{where}: values are needed for {', '.join(sorted(others))}")
    if e.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise ModelError(f"{where}: not finite: {e}")
    return e.xreplace({x: exact(x) for x in e.atoms(sp.Float, sp.NumberSymbol)})


def _degrees(e: sp.Expr) -> tuple[int, int]:
    """Bounds of the degrees in s of numerator and denominator, before anything is multiplied."""
    if e.is_Pow and e.exp.is_Integer:
        above, below = (side * abs(int(e.exp)) for side in _degrees(e.base))
        return (above, below) if e.exp > 0 else (below, above)
    parts = list(map(_degrees, e.args)) or [(int(e == S), 0)]
    below = sum(q for _, q in parts)
    if e.is_Mul:
        return sum(p for p, _ in parts), below
    return max(p + below - q for p, q in parts), below


def _check_degree(degree: int, most: int = _HIGHEST) -> None:
    if degree > most:
        raise ModelError(
            f"impedance: of degree {degree} in s, expected at most {_HIGHEST}: exact tests of more "
            "would take minutes"
        )


def impedance_of(above: Any, below: Any) -> Impedance:
    """The impedance above/below of elements of a ring, polynomials in its first generator, s."""
    if not below:
        raise ModelError("impedance: division by zero")
    p, q = above.cancel(below)
    return Impedance(*(as_poly(side.mul_ground(1 / q.LC), S) for side in (p, q)))


def _from_control(system: Any) -> Impedance:
    if system.isdtime(strict=True):
        raise ModelError(
            "impedance: a discrete system; see sampled_passivity for sampled controllers"
        )
    if (system.ninputs, system.noutputs) != (1, 1):
        raise ModelError(
            f"impedance: expected one input and one output, found {system.ninputs} and "
            f"{system.noutputs}; see two_port"
        )
    if hasattr(system, "num"):
        p, q = ([exact(c) for c in row[0][0]] for row in (system.num, system.den))
        _check_degree(max(len(p), len(q)) - 1)
        return _with_unseen(*(element(sp.Poly(c, S, domain="QQ")) for c in (p, q)))
    if not hasattr(system, "A"):
        raise ModelError(f"impedance: no linear system: {type(system).__name__}")
    _check_degree(len(system.A))
    return from_state_space(system.A, system.B, system.C, system.D)


def from_state_space(a: Any, b: Any, c: Any, d: Any) -> Impedance:
    """C (s I - A)^-1 B + D as an exact impedance; modes that the port does not show cancel.

    a: (n, n), b: (n, 1), c: (1, n), d: (1, 1)
    """
    a, b, c, d = (
        [[fraction(exact(x)) for x in row] for row in np.atleast_2d(m)] for m in (a, b, c, d)
    )
    below, above = resolvent(a, [row[0] for row in b], c[0])
    q = sp.Poly(below, S, domain="QQ")
    p = sp.Poly(above or [Fraction(0)], S, domain="QQ") + q.mul_ground(sp.Rational(d[0][0]))
    return _with_unseen(element(p), element(q))


def _with_unseen(above: Any, below: Any) -> Impedance:
    """The impedance above/below of a system; the roots that cancel are modes that it hides."""
    return replace(impedance_of(above, below), unseen=not_decaying(as_poly(above.gcd(below), S)))


def not_decaying(p: sp.Poly) -> tuple[complex, ...]:
    """Roots that are not in the open left half plane, one of each pair; none, decided exactly."""
    if is_hurwitz(p):
        return ()
    s = roots_of(element(p.sqf_part()))
    near = s[(s.real >= -_NEAR * np.abs(s)) & (s.imag >= 0)]
    return tuple(map(complex, near if len(near) else s[[s.real.argmax()]]))

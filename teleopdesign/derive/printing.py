"""Expressions in blocks as a paper writes them: Gamma for I + H, subtracted terms last."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp
from sympy.printing.latex import LatexPrinter, greek_letters_set
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.str import StrPrinter

from ..realise.lti import S

#: from here on a numerator or a denominator is not read as a fraction; 1/20 is
_LONG = 10_000


def block_symbol(name: str) -> sp.Symbol:
    """A symbol for the named block; it does not commute with other blocks, as matrices do not."""
    return sp.Symbol(name, commutative=False)


def motion_controller_symbol(name: str) -> sp.Symbol:
    """Symbol V_K of a controller K for the motion along whose velocity it acts.

    If that motion is not its input: output = K input + V_K motion
    """
    return block_symbol(f"V_{name}")


def delay_symbol(name: str) -> sp.Expr:
    """Transfer function e^(-s T) of a delay block, its name for T; commutes with all blocks."""
    return sp.exp(-S * dead_time_symbol(name))


def dead_time_symbol(name: str) -> sp.Symbol:
    """Symbol of the dead time (s) of the named delay block."""
    return sp.Symbol(name, positive=True)


def with_gamma(expression: sp.Expr) -> sp.Expr:
    """The expression with the symbol Gamma for I + H: X + H X becomes Gamma X."""
    if not expression.args:
        return expression
    expression = expression.func(*(with_gamma(a) for a in expression.args))
    h, gamma = block_symbol("H"), block_symbol("Gamma")
    if expression.is_Add:
        terms = set(expression.args)
        for term in expression.args:
            if h * term in terms and term in terms:
                terms = (terms - {term, h * term}) | {gamma * term}
        return sp.Add(*terms)
    return expression


def _sort_terms(expression: sp.Add) -> list[tuple[bool, sp.Expr]]:
    """Sorted (is subtracted, term): blocks before their products, subtracted terms last."""
    terms = [(bool(t.as_coeff_Mul()[0] < 0), t) for t in expression.args]
    rank = sorted(terms, key=lambda x: (x[0], len(sp.Mul.make_args(x[1])), str(x[1])))
    return [(negative, -t if negative else t) for negative, t in rank]


def _strip_plus(terms: str) -> str:
    """The sum without a leading plus; a leading minus is joined to its term."""
    return f"-{terms[3:]}" if terms.startswith(" - ") else terms.removeprefix(" + ")


class _Text(StrPrinter):
    def _print_Add(self, expr: sp.Add, order: Any = None) -> str:
        out = ""
        for negative, term in _sort_terms(expr):
            one = "I" if term == 1 else self.parenthesize(term, PRECEDENCE["Add"])
            out += (" - " if negative else " + ") + one
        return _strip_plus(out)

    def _print_Mul(self, expr: sp.Mul) -> str:
        number = expr.as_coeff_Mul()[0]
        negative = bool(number < 0)
        factors = [abs(a) if a == number else a for a in expr.args if a != -1]
        text = " ".join(self.parenthesize(a, PRECEDENCE["Mul"]) for a in factors)
        return f"-{text}" if negative else text

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        return f"{self.parenthesize(expr.base, PRECEDENCE['Pow'])}^{expr.exp}"


class _Latex(LatexPrinter):
    def _print_Add(self, expr: sp.Add, order: Any = None) -> str:
        out = ""
        for negative, term in _sort_terms(expr):
            out += (" - " if negative else " + ") + ("I" if term == 1 else self._print(term))
        return _strip_plus(out)


def _with_short_numbers(expression: sp.Expr) -> sp.Expr:
    """The expression with six digits of each fraction that has more digits than a reader takes in.

    A lever arm such as 0.1 cos(0.5) is exact in the expression, a fraction of 30 digits.
    """
    numbers = {x for x in expression.atoms(sp.Rational) if max(abs(x.p), x.q) >= _LONG}
    return expression.xreplace({x: sp.Float(x, 6) for x in numbers if not x.is_Integer})


def as_text(expression: sp.Expr) -> str:
    """The expression as plain text, such as "Z_H (Z_M + Gamma Z_H - C)^-1 Gamma"."""
    return str(_Text({"full_prec": False}).doprint(_with_short_numbers(expression)))


def as_latex(expression: sp.Expr) -> str:
    """The expression as LaTeX, with the blocks in their order."""
    return str(_Latex().doprint(_with_short_numbers(expression)))


def name_as_latex(name: str) -> str:
    """The name of a transfer function as LaTeX: That_M and R_M/R_D with their indices in braces."""
    return "/".join(_symbol_text(part) for part in name.split("/"))


def _symbol_text(name: str) -> str:
    head, _, index = name.partition("_")
    head = rf"\hat {head.removesuffix('hat')}" if head.endswith("hat") else head
    head = sp.latex(sp.Symbol(head)) if head in greek_letters_set else head
    if not index:
        return head
    return f"{head}_{{{index}}}" if len(index) == 1 else rf"{head}_{{\mathrm{{{index}}}}}"


def polynomial_as_text(coefficients: Sequence[float]) -> str:
    """A polynomial such as 2 s^2 + 3.5 s - 1, from the highest power, with four digits."""
    n, out = len(coefficients) - 1, ""
    for k, c in enumerate(coefficients):
        if c == 0 and n > 0:
            continue
        power = {0: "", 1: "s"}.get(n - k, f"s^{n - k}")
        size = f"{abs(c):.4g}" if abs(c) != 1 or not power else ""
        out += (" - " if c < 0 else " + ") + " ".join(w for w in (size, power) if w)
    out = out or " + 0"
    return out[3:] if out.startswith(" + ") else f"-{out[3:]}"

"""Expressions of positions as the text that `read_expression` reads."""

from __future__ import annotations

import sympy as sp
from sympy.printing.str import StrPrinter

from ..base.errors import ExperimentError, ModelError, quote
from .expressions import read_expression


class _Printer(StrPrinter):
    """Prints like sympy, but floats with all their digits."""

    def _print_Float(self, expr: sp.Float) -> str:
        return repr(float(expr))

    def _print_Abs(self, expr: sp.Abs) -> str:
        return f"abs({self._print(expr.args[0])})"

    def _print_Exp1(self, expr: sp.Expr) -> str:
        return "exp(1)"


def expression_text(expression: sp.Expr, *, name: str) -> str:
    """Text that `read_expression` reads as the same expression.

    name: of the part, for the message
    raises ModelError: there is no such text, because of other functions or unusual names
    """
    text = str(_Printer().doprint(expression))
    try:
        same = read_expression(text, where=name) == expression
    except ExperimentError as error:
        raise ModelError(f"{error}: it has no form in a file") from None
    if not same:
        raise ModelError(f"{name}: {quote(text)} has no form in a file: it reads as another")
    return text

"""Formulas as a few short lines in a box."""

from __future__ import annotations

import sympy as sp
from sympy.printing.str import StrPrinter

from .network import MINUS

#: characters of a line, and lines of a box; what is longer is not shown
LONGEST, MOST = 34, 4


class _Printer(StrPrinter):
    """Prints formulas as people write them: numbers have four digits."""

    def _print_Float(self, expr: sp.Float) -> str:
        return f"{float(expr):.4g}"


def formula(expression: sp.Expr, *, short: str) -> tuple[str, ...]:
    """The expression on lines of its terms; `short` if these lines are too long or too many."""
    terms = sp.Add.make_args(sp.sympify(expression, strict=True))
    lines: list[str] = []
    for term in sorted(terms, key=sp.default_sort_key):
        text = _pretty(term)
        text = text if not lines or text.startswith(MINUS) else f"+ {text}"
        if lines and len(lines[-1]) + len(text) < LONGEST:
            lines[-1] += f" {text}"
        else:
            lines.append(text)
    readable = len(lines) <= MOST and all(len(line) <= LONGEST for line in lines)
    return tuple(lines) if readable else (short,)


def _pretty(expression: sp.Expr) -> str:
    text = str(_Printer().doprint(expression))
    return text.replace("**", "^").replace("*", " ").replace("-", MINUS)

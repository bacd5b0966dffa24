"""Expressions of positions as text: lever arms and kinematics, read without running anything.

    "0.3*cos(q_1) + 0.2*cos(q_1 + q_2)"

Numbers, names of positions, + - * / **, pi, and the functions of `FUNCTIONS`. The text goes through
Python's syntax tree; nothing in it is ever evaluated as code.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter

from ..errors import ExperimentError, ModelError, did_you_mean, quoted
from .parts import position_symbol

#: name -> (function, number of arguments)
FUNCTIONS: Mapping[str, tuple[Callable[..., sp.Expr], int]] = MappingProxyType(
    {
        "sin": (sp.sin, 1),
        "cos": (sp.cos, 1),
        "tan": (sp.tan, 1),
        "asin": (sp.asin, 1),
        "acos": (sp.acos, 1),
        "atan": (sp.atan, 1),
        "atan2": (sp.atan2, 2),
        "sqrt": (sp.sqrt, 1),
        "exp": (sp.exp, 1),
        # what sympy makes of the others: sqrt(x^2), its derivative, tan(pi/2 - x) ...
        "abs": (sp.Abs, 1),
        "sign": (sp.sign, 1),
        "cot": (sp.cot, 1),
        "sec": (sp.sec, 1),
        "csc": (sp.csc, 1),
    }
)
_OPERATORS: Mapping[type, Callable[[Any, Any], sp.Expr]] = MappingProxyType(
    {
        ast.Add: operator.add,
        ast.Sub: operator.sub,
        ast.Mult: operator.mul,
        ast.Div: operator.truediv,
    }
)
#: longest text, largest power that is a number, bits of a fraction: what geometry never reaches,
#: and what keeps `9**9**9**9` from taking an hour
_LONGEST, _LARGEST_POWER, _MOST_BITS = 10_000, 64, 4096


def read_expression(text: str, *, where: str) -> sp.Expr:
    """The expression on `position_symbol`s.

    where: beginning of a message
    raises ExperimentError: what is no expression of those, or has no finite real value
    """
    if len(text) > _LONGEST:
        raise ExperimentError(f"{where}: found {len(text)} characters, at most {_LONGEST}")
    try:
        tree = ast.parse(text.strip(), mode="eval")
        return _checked(_built(tree.body))
    except (SyntaxError, RecursionError, MemoryError, ValueError):
        raise ExperimentError(f"{where}: found {quoted(text)}, expected an expression") from None
    except ModelError as error:
        raise ExperimentError(f"{where}: {error}") from None


def _built(node: ast.expr) -> sp.Expr:
    if isinstance(node, ast.Constant):
        return _number(node.value)
    if isinstance(node, ast.Name):
        return sp.pi if node.id == "pi" else position_symbol(node.id)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
        inside = _built(node.operand)
        return -inside if isinstance(node.op, ast.USub) else inside
    if isinstance(node, ast.BinOp):
        left, right = _built(node.left), _built(node.right)
        if isinstance(node.op, ast.Pow):
            return _power(left, right)
        if type(node.op) in _OPERATORS:
            return _checked(_OPERATORS[type(node.op)](left, right))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        return _called(node.func.id, [_built(a) for a in node.args])
    raise ModelError(
        f"found {quoted(ast.unparse(node))}, expected numbers, positions, + - * / **, pi, "
        f"{', '.join(FUNCTIONS)}"
    )


def _number(value: object) -> sp.Expr:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ModelError(f"found {quoted(repr(value))}, expected a number")
    return _checked(sp.Integer(value) if isinstance(value, int) else sp.Float(value))


def _called(name: str, arguments: list[sp.Expr]) -> sp.Expr:
    if name not in FUNCTIONS:
        raise ModelError(
            f"found function {quoted(name)}, expected {', '.join(FUNCTIONS)}"
            f"{did_you_mean(name, FUNCTIONS)}"
        )
    function, count = FUNCTIONS[name]
    if len(arguments) != count:
        raise ModelError(f"{name}: found {len(arguments)} arguments, expected {count}")
    return _checked(function(*arguments))


def _power(base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    if exponent.is_number and not abs(exponent) <= _LARGEST_POWER:
        raise ModelError(f"found a power larger than {_LARGEST_POWER} in size")
    return _checked(base**exponent)


def _checked(expression: sp.Expr) -> sp.Expr:
    """The expression if its numbers are finite, real and of moderate size."""
    imaginary = expression.is_number and expression.is_real is False
    if imaginary or expression.has(sp.nan, sp.oo, -sp.oo, sp.zoo, sp.I):
        raise ModelError("has no finite real value")
    if expression.is_Rational and max(map(int.bit_length, _parts(expression))) > _MOST_BITS:
        raise ModelError(f"found a number of more than {_MOST_BITS} bits")
    return expression


def _parts(number: sp.Expr) -> tuple[int, int]:
    return int(number.p), int(number.q)


class _Printer(StrPrinter):
    """As sympy prints, but floats with all their digits."""

    def _print_Float(self, expr: sp.Float) -> str:
        return repr(float(expr))

    def _print_Abs(self, expr: sp.Abs) -> str:
        return f"abs({self._print(expr.args[0])})"

    def _print_Exp1(self, expr: sp.Expr) -> str:
        return "exp(1)"


def expression_text(expression: sp.Expr, *, name: str) -> str:
    """Text that `read_expression` reads as the same expression.

    name: of what it belongs to, for the message
    raises ModelError: it has no such text, for it holds other functions or odd names
    """
    text = str(_Printer().doprint(expression))
    try:
        same = read_expression(text, where=name) == expression
    except ExperimentError as error:
        raise ModelError(f"{error}: it has no form in a file") from None
    if not same:
        raise ModelError(f"{name}: {quoted(text)} has no form in a file: it reads as another")
    return text

"""Expressions of positions as text: lever arms and kinematics, read without running any code.

"0.3*cos(q_1) + 0.2*cos(q_1 + q_2)"

Numbers, names of positions, + - * / **, pi, and the functions of `FUNCTIONS`. The text goes through
Python's syntax tree; nothing in it is ever evaluated as code. What is larger than the bounds of
`expression_bounds.py` is refused before sympy sees it.
"""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

import sympy as sp
from sympy.core.cache import clear_cache

from ..base.errors import ExperimentError, ModelError, check_name, did_you_mean, quote
from .expression_bounds import (
    DEEPEST,
    FUNCTIONS,
    LARGEST_POWER,
    LONGEST,
    MOST_BITS,
    MOST_PARTS,
    NO_VALUE,
    BoundedParts,
    Endless,
    compute_finite,
    count_terms,
    fraction_parts,
    limit_work,
    raise_power,
)
from .junctions import position_symbol

_OPERATORS: Mapping[type, Callable[[sp.Expr, sp.Expr], sp.Expr]] = MappingProxyType(
    {
        ast.Add: operator.add,
        ast.Sub: operator.sub,
        ast.Mult: operator.mul,
        ast.Div: operator.truediv,
    }
)


def read_expression(text: str, *, where: str) -> sp.Expr:
    """The expression of `position_symbol`s that a text states.

    where: beginning of a message
    raises ExperimentError: no such expression, no finite real value, or larger than
        `expression_bounds.py` allows
    """
    if len(text) > LONGEST:
        raise ExperimentError(f"{where}: found {len(text)} characters, at most {LONGEST}")
    if not text.isascii():  # Python reads letters of other scripts as those that look like them
        odd = next(c for c in text if not c.isascii())
        raise ExperimentError(f"{where}: found {quote(odd)}, expected plain letters and signs")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's, on text that is refused below anyway
            tree = ast.parse(text.strip(), mode="eval")
        with limit_work():
            return _Reader().read(tree.body)
    except (SyntaxError, RecursionError, MemoryError, ValueError):
        raise ExperimentError(f"{where}: found {quote(text)}, expected an expression") from None
    except Endless:
        clear_cache()  # of what sympy was about to find out
        raise ExperimentError(f"{where}: {quote(text)} takes sympy too long to read") from None
    except (ArithmeticError, NotImplementedError, TypeError):  # sympy on what makes no sense
        raise ExperimentError(f"{where}: {quote(text)} has no value that sympy knows") from None
    except ModelError as error:
        raise ExperimentError(f"{where}: {error}") from None


class _Reader:
    """Reads one text;  count: of numbers, names and signs so far."""

    def __init__(self) -> None:
        self.count = 0
        self.parts = BoundedParts()

    def read(self, node: ast.expr) -> sp.Expr:
        whole = self._build(node, 0)
        if whole.has(sp.nan, sp.oo, -sp.oo, sp.zoo, sp.I):
            raise ModelError(NO_VALUE)
        for part in sp.preorder_traversal(whole):
            self.parts.value(part)
        return whole

    def _build(self, node: ast.expr, depth: int) -> sp.Expr:
        self.count += 1
        if self.count > MOST_PARTS:
            raise ModelError(f"found more than {MOST_PARTS} numbers, names and signs")
        if depth > DEEPEST:
            raise ModelError(f"found more than {DEEPEST} brackets, one inside the other")
        if isinstance(node, ast.Constant):
            return self.parts.check(_read_number(node.value))
        if isinstance(node, ast.Name):
            return sp.pi if node.id == "pi" else position_symbol(check_name(node.id, where="name"))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            inside = self._build(node.operand, depth + 1)
            return -inside if isinstance(node.op, ast.USub) else inside
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            return self._build_chain(node, depth)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            return self._build_power(*(self._build(n, depth + 1) for n in (node.left, node.right)))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            return self._call(node.func.id, [self._build(a, depth + 1) for a in node.args])
        raise ModelError(
            f"found {quote(ast.unparse(node))}, expected numbers, positions, + - * / **, pi, "
            f"{', '.join(FUNCTIONS)}"
        )

    def _build_chain(self, node: ast.BinOp, depth: int) -> sp.Expr:
        """Build a + b - c, or a * b / c, of any length, from left to right; numbers are apart."""
        whole: type[sp.Expr] = sp.Add if isinstance(node.op, ast.Add | ast.Sub) else sp.Mul
        number: sp.Expr = whole.identity
        rest = []
        for operation, part in _list_links(node):
            term = self._build(part, depth + 1)
            one = _OPERATORS[operation](whole.identity, term)
            if term.is_Number:
                number = self.parts.check(_OPERATORS[operation](number, term))
            else:
                rest.append(self.parts.check(one))
        return self.parts.check(whole(number, *rest))

    def _build_power(self, base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
        values = self.parts.value(base), self.parts.value(exponent)
        if values[1] is not None and not abs(values[1]) <= LARGEST_POWER:
            raise ModelError(f"found a power larger than {LARGEST_POWER} in size")
        compute_finite(raise_power, *values)
        if exponent.is_Integer and not base.is_number:
            self.parts.check_size(count_terms(self.parts.size(base), abs(int(exponent))))
        if base.is_Rational and exponent.is_Integer:
            bits = max(map(int.bit_length, fraction_parts(base))) * abs(int(exponent))
            if bits > MOST_BITS:
                raise ModelError(f"found a number of more than {MOST_BITS} bits")
        return self.parts.check(base**exponent)

    def _call(self, name: str, arguments: list[sp.Expr]) -> sp.Expr:
        if name not in FUNCTIONS:
            raise ModelError(
                f"found function {quote(name)}, expected {', '.join(FUNCTIONS)}"
                f"{did_you_mean(name, FUNCTIONS)}"
            )
        function = FUNCTIONS[name]
        if len(arguments) != function.arguments:
            count = function.arguments
            raise ModelError(f"{name}: found {len(arguments)} arguments, expected {count}")
        values = [self.parts.value(a) for a in arguments]
        compute_finite(function.value, *values)
        return self.parts.check(function.symbolic(*arguments))


def _list_links(node: ast.BinOp) -> Iterator[tuple[type, ast.expr]]:
    """The operands of a chain of sums or of products, from left to right, with their operators."""
    pair = (ast.Add, ast.Sub) if isinstance(node.op, ast.Add | ast.Sub) else (ast.Mult, ast.Div)
    links: list[tuple[type, ast.expr]] = []
    left: ast.expr = node
    while isinstance(left, ast.BinOp) and isinstance(left.op, pair):
        links.append((type(left.op), left.right))
        left = left.left
    yield pair[0], left
    yield from reversed(links)


def _read_number(value: object) -> sp.Expr:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ModelError(f"found {quote(repr(value))}, expected a number")
    if isinstance(value, int) and value.bit_length() > MOST_BITS:
        raise ModelError(f"found a number of more than {MOST_BITS} bits")
    if not math.isfinite(value):
        raise ModelError(NO_VALUE)
    return sp.Integer(value) if isinstance(value, int) else sp.Float(value)

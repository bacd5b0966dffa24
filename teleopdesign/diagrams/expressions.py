"""Expressions of positions as text: lever arms and kinematics, read without running anything.

"0.3*cos(q_1) + 0.2*cos(q_1 + q_2)"

Numbers, names of positions, + - * / **, pi, and the functions of `FUNCTIONS`. The text goes through
Python's syntax tree; nothing in it is ever evaluated as code. Every number that a part of the text
has is computed in floating point first, and the size of every part is bounded: what would take
sympy for ever, or fill the memory, is refused before sympy sees it.
"""

from __future__ import annotations

import ast
import math
import operator
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import comb
from types import FrameType, MappingProxyType
from typing import NamedTuple

import sympy as sp
from sympy.core.cache import clear_cache

from ..errors import ExperimentError, ModelError, did_you_mean, quote
from ..names import check_name
from .parts import position_symbol


class _Function(NamedTuple):
    """What sympy makes of it, its value, its number of arguments."""

    symbolic: Callable[..., sp.Expr]
    value: Callable[..., float]
    arguments: int = 1


_TABLE = {
    "sin": _Function(sp.sin, math.sin),
    "cos": _Function(sp.cos, math.cos),
    "tan": _Function(sp.tan, math.tan),
    "asin": _Function(sp.asin, math.asin),
    "acos": _Function(sp.acos, math.acos),
    "atan": _Function(sp.atan, math.atan),
    "atan2": _Function(sp.atan2, math.atan2, 2),
    "sqrt": _Function(sp.sqrt, math.sqrt),
    "exp": _Function(sp.exp, math.exp),
    # what sympy makes of the others: sqrt(x^2), its derivative, tan(pi/2 - x) ...
    "abs": _Function(sp.Abs, abs),
    "sign": _Function(sp.sign, lambda x: math.copysign(float(x != 0), x)),
    "cot": _Function(sp.cot, lambda x: 1.0 / math.tan(x)),
    "sec": _Function(sp.sec, lambda x: 1.0 / math.cos(x)),
    "csc": _Function(sp.csc, lambda x: 1.0 / math.sin(x)),
}
#: functions that a text may hold, by name
FUNCTIONS: Mapping[str, _Function] = MappingProxyType(_TABLE)
_VALUES = {f.symbolic: f.value for f in _TABLE.values()} | {sp.exp: math.exp}
_OPERATORS: Mapping[type, Callable[[sp.Expr, sp.Expr], sp.Expr]] = MappingProxyType(
    {
        ast.Add: operator.add,
        ast.Sub: operator.sub,
        ast.Mult: operator.mul,
        ast.Div: operator.truediv,
    }
)
#: what geometry never reaches, and what keeps a text from taking an hour: characters; parts and
#: brackets in brackets of the text; a power that is a number, also where powers of powers meet;
#: bits of a fraction; terms of what is multiplied out; roots and functions of numbers, one inside
#: the other (sympy's assumptions about them double their work with each); different roots of
#: numbers (in a product it compares each with each)
_LONGEST, _MOST_PARTS, _DEEPEST = 10_000, 4_000, 60
_LARGEST_POWER, _MOST_BITS, _MOST_TERMS, _DEEPEST_NUMBER = 64, 1024, 10_000, 8
_MOST_ROOTS = 24
#: calls and returns of Python that reading may take, about 1 s: no bound on a text's form tells
#: how long sympy thinks about it. The tip of an arm of six joints takes 0.12 million, a sum of 600
#: sines of as many positions 5 million: then it stops.
_MOST_CALLS = 4_000_000
_NO_VALUE = "has no finite real value"


def read_expression(text: str, *, where: str) -> sp.Expr:
    """The expression on `position_symbol`s.

    where: beginning of a message
    raises ExperimentError: what is no expression of those, has no finite real value, or is larger
        than the bounds of this module
    """
    if len(text) > _LONGEST:
        raise ExperimentError(f"{where}: found {len(text)} characters, at most {_LONGEST}")
    if not text.isascii():  # Python reads letters of other scripts as those that look like them
        odd = next(c for c in text if not c.isascii())
        raise ExperimentError(f"{where}: found {quote(odd)}, expected plain letters and signs")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's, on text that is refused below anyway
            tree = ast.parse(text.strip(), mode="eval")
        with _bounded_work():
            return _Reader().read(tree.body)
    except (SyntaxError, RecursionError, MemoryError, ValueError):
        raise ExperimentError(f"{where}: found {quote(text)}, expected an expression") from None
    except _Endless:
        clear_cache()  # of what sympy was about to find out
        raise ExperimentError(f"{where}: {quote(text)} takes sympy too long to read") from None
    except (ArithmeticError, NotImplementedError, TypeError):  # sympy on what makes no sense
        raise ExperimentError(f"{where}: {quote(text)} has no value that sympy knows") from None
    except ModelError as error:
        raise ExperimentError(f"{where}: {error}") from None


class _Endless(BaseException):
    """The limit of work is reached; not an `Exception`, so that no library catches it."""


@contextmanager
def _bounded_work() -> Iterator[None]:
    """Stop a computation after `_MOST_CALLS` calls of Python; the same on every machine."""
    left, before = _MOST_CALLS, sys.getprofile()

    def count(frame: FrameType, event: str, argument: object) -> None:
        nonlocal left
        left -= 1
        # at calls of C only: raised where Python closes a generator, it would be lost
        if left < 0 and event == "c_call":
            raise _Endless

    sys.setprofile(count)
    try:
        yield
    finally:
        sys.setprofile(before)


class _Reader:
    """Reads one text; remembers the value and the size of every part."""

    def __init__(self) -> None:
        self.parts = 0
        self.values: dict[sp.Expr, float | None] = {}
        self.sizes: dict[sp.Expr, int] = {}
        self.depths: dict[sp.Expr, int] = {}
        self.roots: set[sp.Expr] = set()

    def read(self, node: ast.expr) -> sp.Expr:
        whole = self._built(node, 0)
        if whole.has(sp.nan, sp.oo, -sp.oo, sp.zoo, sp.I):
            raise ModelError(_NO_VALUE)
        for part in sp.preorder_traversal(whole):
            self._value(part)
        return whole

    def _built(self, node: ast.expr, depth: int) -> sp.Expr:
        self.parts += 1
        if self.parts > _MOST_PARTS:
            raise ModelError(f"found more than {_MOST_PARTS} numbers, names and signs")
        if depth > _DEEPEST:
            raise ModelError(f"found more than {_DEEPEST} brackets, one inside the other")
        if isinstance(node, ast.Constant):
            return self._checked(_number(node.value))
        if isinstance(node, ast.Name):
            return sp.pi if node.id == "pi" else position_symbol(check_name(node.id, where="name"))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            inside = self._built(node.operand, depth + 1)
            return -inside if isinstance(node.op, ast.USub) else inside
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            return self._chain(node, depth)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            return self._power(*(self._built(n, depth + 1) for n in (node.left, node.right)))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            return self._called(node.func.id, [self._built(a, depth + 1) for a in node.args])
        raise ModelError(
            f"found {quote(ast.unparse(node))}, expected numbers, positions, + - * / **, pi, "
            f"{', '.join(FUNCTIONS)}"
        )

    def _chain(self, node: ast.BinOp, depth: int) -> sp.Expr:
        """a + b - c, or a * b / c: from left to right, however long; numbers are kept apart."""
        whole: type[sp.Expr] = sp.Add if isinstance(node.op, ast.Add | ast.Sub) else sp.Mul
        number: sp.Expr = whole.identity
        rest = []
        for operation, part in _links(node):
            term = self._built(part, depth + 1)
            one = _OPERATORS[operation](whole.identity, term)
            if term.is_Number:
                number = self._checked(_OPERATORS[operation](number, term))
            else:
                rest.append(self._checked(one))
        return self._checked(whole(number, *rest))

    def _power(self, base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
        values = self._value(base), self._value(exponent)
        if values[1] is not None and not abs(values[1]) <= _LARGEST_POWER:
            raise ModelError(f"found a power larger than {_LARGEST_POWER} in size")
        _finite(_raise_power, *values)
        if exponent.is_Integer and not base.is_number:
            self._check_size(_count_terms(self._size(base), abs(int(exponent))))
        if base.is_Rational and exponent.is_Integer:
            bits = max(map(int.bit_length, _parts(base))) * abs(int(exponent))
            if bits > _MOST_BITS:
                raise ModelError(f"found a number of more than {_MOST_BITS} bits")
        return self._checked(base**exponent)

    def _called(self, name: str, arguments: list[sp.Expr]) -> sp.Expr:
        if name not in FUNCTIONS:
            raise ModelError(
                f"found function {quote(name)}, expected {', '.join(FUNCTIONS)}"
                f"{did_you_mean(name, FUNCTIONS)}"
            )
        function = FUNCTIONS[name]
        if len(arguments) != function.arguments:
            count = function.arguments
            raise ModelError(f"{name}: found {len(arguments)} arguments, expected {count}")
        values = [self._value(a) for a in arguments]
        _finite(function.value, *values)
        return self._checked(function.symbolic(*arguments))

    def _checked(self, expression: sp.Expr) -> sp.Expr:
        """The expression if its numbers, its powers and its size are moderate."""
        if expression in (sp.nan, sp.oo, -sp.oo, sp.zoo):
            raise ModelError(_NO_VALUE)
        for part in (expression, *expression.args):
            self._value(part)
            if part.is_Pow:
                power = self._value(part.exp)
                if power is not None and not abs(power) <= _LARGEST_POWER:
                    raise ModelError(f"found a power larger than {_LARGEST_POWER} in size")
        self._check_size(self._size(expression))
        return expression

    def _value(self, expression: sp.Expr) -> float | None:
        """The number that it is, None where it holds a position; ModelError where it is none."""
        if expression not in self.values:
            self.values[expression] = self._computed(expression)
        return self.values[expression]

    def _computed(self, expression: sp.Expr) -> float | None:
        if expression.is_Symbol:
            return None
        if expression in (sp.nan, sp.oo, -sp.oo, sp.zoo, sp.I):
            raise ModelError(_NO_VALUE)
        if expression.is_Rational and max(map(int.bit_length, _parts(expression))) > _MOST_BITS:
            raise ModelError(f"found a number of more than {_MOST_BITS} bits")
        if not expression.args:
            return _finite(float, expression)
        values = [self._value(a) for a in expression.args]
        if expression.is_number:
            self.depths[expression] = 1 + max(self.depths.get(a, 0) for a in expression.args)
            if self.depths[expression] > _DEEPEST_NUMBER:
                raise ModelError(
                    f"found a number of more than {_DEEPEST_NUMBER} operations, one in the other"
                )
        if expression.is_Add:
            return _finite(lambda *x: math.fsum(x), *values)
        if expression.is_Mul:
            return _finite(lambda *x: math.prod(x), *values)
        if expression.is_Pow:
            if expression.is_number:
                self.roots.add(expression)
            if len(self.roots) > _MOST_ROOTS:
                raise ModelError(f"found more than {_MOST_ROOTS} roots of numbers")
            return _finite(_raise_power, *values)
        if expression.func in _VALUES:
            return _finite(_VALUES[expression.func], *values)
        return None  # of other functions that sympy may make of these, only the arguments are known

    def _size(self, expression: sp.Expr) -> int:
        """Terms that it has once it is multiplied out, at least one."""
        if not expression.args or expression.is_number:
            return 1
        if expression not in self.sizes:
            self.sizes[expression] = self._counted(expression)
        return self.sizes[expression]

    def _counted(self, expression: sp.Expr) -> int:
        if expression.is_Pow and expression.exp.is_Integer:
            return _count_terms(self._size(expression.base), abs(int(expression.exp)))
        sizes = [self._size(a) for a in expression.args]
        if expression.is_Add:
            return sum(sizes)
        # of a function or a root, what is inside is multiplied out by itself
        return math.prod(sizes) if expression.is_Mul else max(sizes)

    def _check_size(self, terms: int) -> None:
        if terms > _MOST_TERMS:
            raise ModelError(f"has more than {_MOST_TERMS} terms when it is multiplied out")


def _links(node: ast.BinOp) -> Iterator[tuple[type, ast.expr]]:
    """The parts of a chain of one kind of operator, from left to right, each with its operator."""
    pair = (ast.Add, ast.Sub) if isinstance(node.op, ast.Add | ast.Sub) else (ast.Mult, ast.Div)
    links: list[tuple[type, ast.expr]] = []
    left: ast.expr = node
    while isinstance(left, ast.BinOp) and isinstance(left.op, pair):
        links.append((type(left.op), left.right))
        left = left.left
    yield pair[0], left
    yield from reversed(links)


def _number(value: object) -> sp.Expr:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ModelError(f"found {quote(repr(value))}, expected a number")
    if isinstance(value, int) and value.bit_length() > _MOST_BITS:
        raise ModelError(f"found a number of more than {_MOST_BITS} bits")
    if not math.isfinite(value):
        raise ModelError(_NO_VALUE)
    return sp.Integer(value) if isinstance(value, int) else sp.Float(value)


def _finite(call: Callable[..., float], *values: object) -> float | None:
    """call(*values), None where one is not known; ModelError where it is no finite real number."""
    if any(v is None for v in values):
        return None
    try:
        result = call(*values)
    except (ArithmeticError, ValueError, TypeError):
        raise ModelError(_NO_VALUE) from None
    if isinstance(result, complex) or not math.isfinite(result):
        raise ModelError(_NO_VALUE)
    return result


def _raise_power(base: float, exponent: float) -> float:
    return float(base**exponent)


def _count_terms(terms: int, power: int) -> int:
    """Terms of a sum of so many to that power."""
    return comb(terms + power - 1, power) if terms > 1 else 1


def _parts(number: sp.Expr) -> tuple[int, int]:
    return int(number.p), int(number.q)

"""Bounds on expressions of positions: functions, values and sizes that a text may have.

Every number in a part is computed in floating point before sympy receives it, and the size of every
part is bounded: expressions that would occupy sympy without end, or fill the memory, are refused.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import comb
from types import FrameType, MappingProxyType
from typing import NamedTuple

import sympy as sp

from ..base.errors import ModelError


class _Function(NamedTuple):
    """The sympy form of a function, its value, and its number of arguments."""

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
#: bounds of a text, which no geometry reaches, and which keep sympy from working for an hour:
#: characters; parts, and brackets inside brackets; a numerical power, also a product of powers;
#: bits of a fraction; terms of an expanded product; nested roots and functions of numbers (each
#: doubles the work of sympy's assumptions); different roots of numbers (in a product sympy compares
#: each pair)
LONGEST, MOST_PARTS, DEEPEST = 10_000, 4_000, 60
LARGEST_POWER, MOST_BITS, _MOST_TERMS, _DEEPEST_NUMBER = 64, 1024, 10_000, 8
_MOST_ROOTS = 24
#: calls and returns of Python that reading a text may take, about 1 s: no bound on the form of a
#: text limits the time that sympy needs. The tip of an arm of six joints takes 0.12 million; a sum
#: of 600 sines of as many positions takes 5 million and is refused
_MOST_CALLS = 4_000_000
NO_VALUE = "has no finite real value"


class Endless(BaseException):
    """The limit of work is reached; not an `Exception`, so that no library catches it."""


@contextmanager
def limit_work() -> Iterator[None]:
    """Stop a computation after `_MOST_CALLS` calls of Python; the same on every machine."""
    left, before = _MOST_CALLS, sys.getprofile()

    def count(frame: FrameType, event: str, argument: object) -> None:
        nonlocal left
        left -= 1
        # at calls of C only: raised where Python closes a generator, it would be lost
        if left < 0 and event == "c_call":
            raise Endless

    sys.setprofile(count)
    try:
        yield
    finally:
        sys.setprofile(before)


class BoundedParts:
    """Value and size of every part of one expression, each computed once and bounded."""

    def __init__(self) -> None:
        self.values: dict[sp.Expr, float | None] = {}
        self.sizes: dict[sp.Expr, int] = {}
        self.depths: dict[sp.Expr, int] = {}
        self.roots: set[sp.Expr] = set()

    def check(self, expression: sp.Expr) -> sp.Expr:
        """The expression; raises ModelError: its numbers, powers or size are too large."""
        if expression in (sp.nan, sp.oo, -sp.oo, sp.zoo):
            raise ModelError(NO_VALUE)
        for part in (expression, *expression.args):
            self.value(part)
            if part.is_Pow:
                power = self.value(part.exp)
                if power is not None and not abs(power) <= LARGEST_POWER:
                    raise ModelError(f"found a power larger than {LARGEST_POWER} in size")
        self.check_size(self.size(expression))
        return expression

    def value(self, expression: sp.Expr) -> float | None:
        """The value of a number, None with a position in it; raises ModelError: no real number."""
        if expression not in self.values:
            self.values[expression] = self._compute(expression)
        return self.values[expression]

    def _compute(self, expression: sp.Expr) -> float | None:
        if expression.is_Symbol:
            return None
        if expression in (sp.nan, sp.oo, -sp.oo, sp.zoo, sp.I):
            raise ModelError(NO_VALUE)
        if (
            expression.is_Rational
            and max(map(int.bit_length, fraction_parts(expression))) > MOST_BITS
        ):
            raise ModelError(f"found a number of more than {MOST_BITS} bits")
        if not expression.args:
            return compute_finite(float, expression)
        values = [self.value(a) for a in expression.args]
        if expression.is_number:
            self.depths[expression] = 1 + max(self.depths.get(a, 0) for a in expression.args)
            if self.depths[expression] > _DEEPEST_NUMBER:
                raise ModelError(
                    f"found a number of more than {_DEEPEST_NUMBER} operations, one in the other"
                )
        if expression.is_Add:
            return compute_finite(lambda *x: math.fsum(x), *values)
        if expression.is_Mul:
            return compute_finite(lambda *x: math.prod(x), *values)
        if expression.is_Pow:
            if expression.is_number:
                self.roots.add(expression)
            if len(self.roots) > _MOST_ROOTS:
                raise ModelError(f"found more than {_MOST_ROOTS} roots of numbers")
            return compute_finite(raise_power, *values)
        if expression.func in _VALUES:
            return compute_finite(_VALUES[expression.func], *values)
        return None  # of other functions that sympy may make of these, only the arguments are known

    def size(self, expression: sp.Expr) -> int:
        """Number of terms after multiplication, at least one."""
        if not expression.args or expression.is_number:
            return 1
        if expression not in self.sizes:
            self.sizes[expression] = self._count(expression)
        return self.sizes[expression]

    def _count(self, expression: sp.Expr) -> int:
        if expression.is_Pow and expression.exp.is_Integer:
            return count_terms(self.size(expression.base), abs(int(expression.exp)))
        sizes = [self.size(a) for a in expression.args]
        if expression.is_Add:
            return sum(sizes)
        # of a function or a root, what is inside is multiplied out by itself
        return math.prod(sizes) if expression.is_Mul else max(sizes)

    def check_size(self, terms: int) -> None:
        if terms > _MOST_TERMS:
            raise ModelError(f"has more than {_MOST_TERMS} terms when it is multiplied out")


def compute_finite(call: Callable[..., float], *values: object) -> float | None:
    """call(*values), None if a value is unknown; raises ModelError: no finite real number."""
    if any(v is None for v in values):
        return None
    try:
        result = call(*values)
    except (ArithmeticError, ValueError, TypeError):
        raise ModelError(NO_VALUE) from None
    if isinstance(result, complex) or not math.isfinite(result):
        raise ModelError(NO_VALUE)
    return result


def raise_power(base: float, exponent: float) -> float:
    return float(base**exponent)


def count_terms(terms: int, power: int) -> int:
    """Number of terms of a sum of `terms` terms to a power."""
    return comb(terms + power - 1, power) if terms > 1 else 1


def fraction_parts(number: sp.Expr) -> tuple[int, int]:
    return int(number.p), int(number.q)

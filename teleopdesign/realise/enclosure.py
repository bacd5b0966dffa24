"""Interval enclosure of a law: bounds of its value over ranges of its symbols.

Where a law is not defined, as a logarithm of a negative number, its interval is the whole line.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from math import inf
from operator import or_
from typing import Any

import sympy as sp
from mpmath import libmp

from ..base.errors import ModelError
from . import interval_arithmetic as arithmetic
from .interval_arithmetic import (
    WHOLE,
    ZERO,
    Enclosure,
    absolute,
    enclose_wave,
    hull,
    multiply,
    negate,
)

#: whether a condition can be true, and whether it can be false
Possible = tuple[bool, bool]

#: arguments of an exponential beyond which it exceeds all floats, or is next to zero
_LARGEST_EXPONENT = 1e3


class Singular(Exception):
    """The law may be undefined or unbounded within the ranges."""


def enclosure_of(
    law: sp.Expr, variables: Sequence[sp.Symbol], *, smooth: bool = False
) -> Callable[[Sequence[Enclosure]], Enclosure]:
    """The law as a function of one interval for each variable.

    The function keeps its last values: parts whose variables are as before are not computed anew.

    smooth: raise `Singular` where the law divides by zero, or takes a root or logarithm of zero
    raises ModelError: the law has a function without a known bound
    """
    places: dict[sp.Basic, int] = {v: i for i, v in enumerate(variables)}
    steps: list[tuple[int, int, Callable[..., Any], tuple[int, ...]]] = []
    # of each place one bit for each variable that its value depends on
    depends = [1 << i for i in range(len(variables))]
    constant = 1 << len(variables)

    def place(node: sp.Basic) -> int:
        if node not in places:
            arguments = tuple(place(a) for a in _arguments(node))
            places[node] = len(depends)
            depends.append(reduce(or_, (depends[i] for i in arguments), 0) or constant)
            operation = _operation(node, smooth)
            steps.append((places[node], depends[-1], operation, arguments))
        return places[node]

    last = place(sp.sympify(law))
    values: list[Any] = [None] * len(depends)
    changed = 2 * constant - 1

    def evaluate(enclosures: Sequence[Enclosure]) -> Enclosure:
        nonlocal changed
        for i, enclosure in enumerate(enclosures):
            if values[i] != enclosure:
                values[i] = enclosure
                changed |= 1 << i
        for at, depend, operation, arguments in steps:
            if depend & changed:
                values[at] = operation(*[values[i] for i in arguments])
        changed = 0  # not where a step raised: these values are computed anew
        value: Enclosure = values[last]
        return value

    return evaluate


def _arguments(node: sp.Basic) -> tuple[sp.Basic, ...]:
    if isinstance(node, sp.Piecewise):
        return tuple(part for pair in node.args for part in (pair.expr, pair.cond))
    if isinstance(node, sp.Pow) and node.exp.is_Rational:
        return (node.base,)
    return () if node.is_Atom else node.args


def _operation(node: sp.Basic, smooth: bool) -> Callable[..., Any]:
    """The operation of a node of the law on the intervals, or possibilities, of its arguments."""
    if node in (sp.true, sp.false):
        return lambda: (node == sp.true, node == sp.false)
    if node.is_Atom:
        constant = _constant(node)
        return lambda: constant
    if isinstance(node, sp.Pow):
        return _power(node, smooth)
    if isinstance(node, sp.log):
        return lambda x: _logarithm(x, smooth)
    if isinstance(node, sp.tan):
        return lambda x: multiply(_sine(x), _reciprocal(_cosine(x), smooth))
    operation = _OPERATIONS.get(node.func)
    if operation is None:
        raise ModelError(f"no guaranteed bound: none is known of {node.func.__name__}(...)")
    return operation


def _constant(node: sp.Basic) -> Enclosure:
    if isinstance(node, sp.Float):
        return arithmetic.outward(node._mpf_, node._mpf_)
    if isinstance(node, sp.Rational) and node.is_finite:
        return arithmetic.constant(lambda bits, way: libmp.from_rational(node.p, node.q, bits, way))
    if node in (sp.pi, sp.E):
        return arithmetic.constant(libmp.mpf_pi if node == sp.pi else libmp.mpf_e)
    raise ModelError(f"no guaranteed bound: none is known of {node}")


def _reciprocal(x: Enclosure, smooth: bool) -> Enclosure:
    if smooth and x[0] <= 0.0 <= x[1]:
        raise Singular
    return arithmetic.reciprocal(x)


def _power(node: sp.Pow, smooth: bool) -> Callable[..., Enclosure]:
    exponent = node.exp
    if not exponent.is_Rational:
        if node.base == sp.E:
            return lambda _, y: _exponential(y)
        return lambda x, y: _exponential(multiply(y, _logarithm(x, smooth)))
    whole, root = abs(int(exponent.p)), int(exponent.q)

    def power(x: Enclosure) -> Enclosure:
        if root != 1:
            if smooth and x[0] <= 0.0:
                raise Singular
            if x[0] < 0.0:
                return WHOLE
            x = _square_root(x) if root == 2 else _enclose_root(x, root)
        x = arithmetic.power(x, whole)
        return _reciprocal(x, smooth) if exponent < 0 else x

    return power


def _square_root(x: Enclosure) -> Enclosure:
    """The root of an interval that is not negative: mpmath rounds it correctly."""
    low, high = (libmp.from_float(end) for end in x)
    bits = arithmetic.BITS
    return arithmetic.outward(
        libmp.mpf_sqrt(low, bits, libmp.round_floor),
        libmp.mpf_sqrt(high, bits, libmp.round_ceiling),
    )


def _enclose_root(x: Enclosure, root: int) -> Enclosure:
    """The root of an interval that is not negative."""
    whole = arithmetic.reciprocal((float(root), float(root)))
    power = _exponential(multiply(_logarithm(x, False), whole))
    return hull(ZERO, power) if x[0] == 0.0 else power


def _logarithm(x: Enclosure, smooth: bool) -> Enclosure:
    if smooth and x[0] <= 0.0:
        raise Singular
    if x[0] < 0.0 or x[1] <= 0.0:
        return WHOLE
    low = -inf if x[0] == 0.0 else _logarithm_of_positive(x[0])[0]
    return low, _logarithm_of_positive(x[1])[1]


def _logarithm_of_positive(x: float) -> Enclosure:
    return (inf, inf) if x == inf else arithmetic.enclose_rising(libmp.mpf_log, (x, x))


def _exponential(x: Enclosure) -> Enclosure:
    low, high = x
    below = 0.0 if low < -_LARGEST_EXPONENT else _exponential_of(min(low, _LARGEST_EXPONENT))[0]
    above = inf if high > _LARGEST_EXPONENT else _exponential_of(max(high, -_LARGEST_EXPONENT))[1]
    least, most = (1.0 if low >= 0.0 else 0.0), (1.0 if high <= 0.0 else inf)
    return arithmetic.limit((below, above), least, most)


def _exponential_of(x: float) -> Enclosure:
    return arithmetic.enclose_rising(libmp.mpf_exp, (x, x))


def _sine(x: Enclosure) -> Enclosure:
    return enclose_wave(libmp.libmpi.mpi_sin, x)


def _cosine(x: Enclosure) -> Enclosure:
    return enclose_wave(libmp.libmpi.mpi_cos, x)


def _half(*parts: Enclosure) -> Enclosure:
    return multiply(_add(*parts), (0.5, 0.5))


def _sign(x: Enclosure) -> Enclosure:
    return _sign_of(x[0]), _sign_of(x[1])


def _sign_of(x: float) -> float:
    return float(x > 0) - float(x < 0)


def _step(x: Enclosure, *_: Any) -> Enclosure:
    return 1.0 if x[0] > 0 else 0.0, 0.0 if x[1] < 0 else 1.0


def _add(*parts: Enclosure) -> Enclosure:
    return reduce(arithmetic.add, parts)


def _multiply_all(*parts: Enclosure) -> Enclosure:
    return reduce(multiply, parts)


def _enclose_minimum(*parts: Enclosure) -> Enclosure:
    return min(p[0] for p in parts), min(p[1] for p in parts)


def _largest(*parts: Enclosure) -> Enclosure:
    return max(p[0] for p in parts), max(p[1] for p in parts)


def _pieces(*parts: Any) -> Enclosure:
    """The hull of the pieces whose condition can be the first that is true."""
    reached: list[Enclosure] = []
    for value, (can_be_true, can_be_false) in zip(parts[::2], parts[1::2], strict=True):
        if can_be_true:
            reached.append(value)
        if not can_be_false:
            return hull(*reached)
    return WHOLE  # undefined where no condition is true


def _compare_below(x: Enclosure, y: Enclosure) -> Possible:
    return x[0] < y[1], x[1] >= y[0]


def _compare_not_above(x: Enclosure, y: Enclosure) -> Possible:
    return x[0] <= y[1], x[1] > y[0]


def _compare_equal(x: Enclosure, y: Enclosure) -> Possible:
    return x[0] <= y[1] and y[0] <= x[1], not (x[0] == x[1] == y[0] == y[1])


def _refute(x: Possible) -> Possible:
    return x[1], x[0]


def _if(condition: Possible, one: Possible, other: Possible) -> Possible:
    if_true, if_false = condition
    return if_true and one[0] or if_false and other[0], if_true and one[1] or if_false and other[1]


_OPERATIONS: Mapping[Any, Callable[..., Any]] = {
    sp.Add: _add,
    sp.Mul: _multiply_all,
    sp.exp: _exponential,
    sp.sin: _sine,
    sp.cos: _cosine,
    sp.tanh: lambda x: arithmetic.limit(arithmetic.enclose_rising(libmp.mpf_tanh, x), -1.0, 1.0),
    sp.atan: lambda x: arithmetic.enclose_rising(libmp.mpf_atan, x),
    sp.sinh: lambda x: _half(_exponential(x), negate(_exponential(negate(x)))),
    sp.cosh: lambda x: _half(_exponential(absolute(x)), _exponential(negate(absolute(x)))),
    sp.Abs: absolute,
    sp.sign: _sign,
    sp.Heaviside: _step,
    sp.Min: _enclose_minimum,
    sp.Max: _largest,
    sp.Piecewise: _pieces,
    sp.StrictLessThan: _compare_below,
    sp.StrictGreaterThan: lambda x, y: _compare_below(y, x),
    sp.LessThan: _compare_not_above,
    sp.GreaterThan: lambda x, y: _compare_not_above(y, x),
    sp.Equality: _compare_equal,
    sp.Unequality: lambda x, y: _refute(_compare_equal(x, y)),
    sp.And: lambda *all_of: (all(x[0] for x in all_of), any(x[1] for x in all_of)),
    sp.Or: lambda *any_of: (any(x[0] for x in any_of), all(x[1] for x in any_of)),
    sp.Not: _refute,
    sp.ITE: _if,
}

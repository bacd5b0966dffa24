"""Interval enclosure of a law: bounds of its value over ranges of its symbols.

The arithmetic is that of mpmath, rounded outward at 53 bits. Operations that mpmath lacks (signs,
pieces, tanh) or encloses too widely (zero times an unbounded range) are defined here. An interval
is a set of real numbers. Where a law is not defined, as a logarithm of a negative number, its
interval is the whole line.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import Any

import sympy as sp
from mpmath import iv, libmp

from ..errors import ModelError

#: an interval of mpmath; mpmath declares no types
Enclosure = Any
#: whether a condition can be true, and whether it can be false
Possible = tuple[bool, bool]

WHOLE: Enclosure = iv.mpf([float("-inf"), float("inf")])
_ZERO, _ONE = iv.mpf(0), iv.mpf(1)
#: largest argument of an exponential: with a larger one the result counts as unbounded, or zero
_LARGEST_EXPONENT = 1e6
#: factor of four units in the last place: mpmath rounds some functions of tiny arguments to the
#: wrong side by one unit, as atan(9e-17) to its argument
_GUARD = iv.mpf([1 - 2.0**-50, 1 + 2.0**-50])


class Singular(Exception):
    """The law may be undefined or unbounded within the ranges."""


def interval(low: float, high: float) -> Enclosure:
    """The interval from low to high, both without rounding."""
    return iv.mpf([low, high])


def ends(value: Enclosure) -> tuple[float, float]:
    """Lower and upper end of an interval, as floats rounded outward."""
    low, high = value._mpi_
    below, above = libmp.to_float(low), libmp.to_float(high)
    # conversion rounds to the nearest float, to zero or infinity beyond the range of floats
    if libmp.mpf_gt(libmp.from_float(below), low):
        below = math.nextafter(below, -math.inf)
    if libmp.mpf_lt(libmp.from_float(above), high):
        above = math.nextafter(above, math.inf)
    return below, above


def enclosure_of(
    law: sp.Expr, variables: Sequence[sp.Symbol], *, smooth: bool = False
) -> Callable[[Sequence[Enclosure]], Enclosure]:
    """The law as a function of one interval for each variable.

    smooth: raise `Singular` where the law divides by zero, or takes a root or logarithm of zero
    raises ModelError: the law has a function without a known bound
    """
    places: dict[sp.Basic, int] = {v: i for i, v in enumerate(variables)}
    steps: list[tuple[Callable[..., Any], tuple[int, ...]]] = []

    def place(node: sp.Basic) -> int:
        if node not in places:
            arguments = tuple(place(a) for a in _arguments(node))
            places[node] = len(variables) + len(steps)
            steps.append((_operation(node, smooth), arguments))
        return places[node]

    last = place(sp.sympify(law))

    def evaluate(enclosures: Sequence[Enclosure]) -> Enclosure:
        values = list(enclosures)
        for operation, arguments in steps:
            values.append(operation(*(values[i] for i in arguments)))
        return values[last]

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
        return lambda x: multiply(
            _enclose_sine(iv.sin(x)), _reciprocal(_enclose_sine(iv.cos(x)), smooth)
        )
    operation = _OPERATIONS.get(node.func)
    if operation is None:
        raise ModelError(f"no guaranteed bound: none is known of {node.func.__name__}(...)")
    return operation


def _constant(node: sp.Basic) -> Enclosure:
    if isinstance(node, sp.Float):
        return iv.make_mpf((node._mpf_, node._mpf_))
    if isinstance(node, sp.Rational) and node.is_finite:
        return iv.mpf(node.p) / iv.mpf(node.q)
    if node in (sp.pi, sp.E):
        return +iv.pi if node == sp.pi else iv.exp(_ONE)
    raise ModelError(f"no guaranteed bound: none is known of {node}")


def multiply(x: Enclosure, y: Enclosure) -> Enclosure:
    """Product; zero times an unbounded range is zero, because a range holds real numbers only."""
    if x.a == 0 == x.b or y.a == 0 == y.b:
        return _ZERO
    return x * y


def _reciprocal(x: Enclosure, smooth: bool) -> Enclosure:
    if x.a <= 0 <= x.b:
        if smooth:
            raise Singular
        if x.a < 0 < x.b or x.a == x.b:
            return WHOLE
    return _ONE / x


def _power(node: sp.Pow, smooth: bool) -> Callable[..., Enclosure]:
    exponent = node.exp
    if not exponent.is_Rational:
        if node.base == sp.E:
            return lambda _, y: _exponential(y)
        return lambda x, y: _exponential(multiply(y, _logarithm(x, smooth)))
    whole, root = abs(int(exponent.p)), int(exponent.q)

    def power(x: Enclosure) -> Enclosure:
        if root != 1:
            if smooth and x.a <= 0:
                raise Singular
            if x.a < 0:
                return WHOLE
            x = iv.sqrt(x) if root == 2 else _enclose_root(x, root)
        x = x**whole
        return _reciprocal(x, smooth) if exponent < 0 else x

    return power


def _enclose_root(x: Enclosure, root: int) -> Enclosure:
    """The root of an interval that is not negative."""
    zero = x.a == 0
    power = _exponential(_logarithm(x, False) / root)
    return _hull(_ZERO, power) if zero else power


def _logarithm(x: Enclosure, smooth: bool) -> Enclosure:
    if smooth and x.a <= 0:
        raise Singular
    return WHOLE if x.a < 0 or x.b <= 0 else multiply(iv.log(x), _GUARD)


def _exponential(x: Enclosure) -> Enclosure:
    low = x.a if x.a > -_LARGEST_EXPONENT else iv.mpf("-inf")
    high = x.b if x.b < _LARGEST_EXPONENT else iv.mpf("inf")
    below = iv.exp(low if x.a < _LARGEST_EXPONENT else iv.mpf(_LARGEST_EXPONENT))
    above = iv.exp(high if x.b > -_LARGEST_EXPONENT else iv.mpf(-_LARGEST_EXPONENT))
    hull = _hull(below, above) * _GUARD
    if x.b <= 0:
        return iv.mpf([hull.a, min(hull.b, _ONE)])
    return iv.mpf([max(hull.a, _ONE), hull.b]) if x.a >= 0 else hull


def _enclose_sine(x: Enclosure) -> Enclosure:
    """The range of a sine, with a guard against rounding."""
    guarded = x * _GUARD
    return iv.mpf([max(guarded.a, -_ONE), min(guarded.b, _ONE)])


def _hull(*parts: Enclosure) -> Enclosure:
    return iv.mpf([min(p.a for p in parts), max(p.b for p in parts)])


def _enclose_rising(function: Callable[..., Any]) -> Callable[[Enclosure], Enclosure]:
    """The interval of an increasing function, from its values at both ends."""

    def enclose(x: Enclosure) -> Enclosure:
        low, high = x._mpi_
        ends = (function(low, 53, libmp.round_floor), function(high, 53, libmp.round_ceiling))
        return iv.make_mpf(ends) * _GUARD

    return enclose


def _sign(x: Enclosure) -> Enclosure:
    return iv.mpf([_sign_of(x.a), _sign_of(x.b)])


def _sign_of(x: Enclosure) -> int:
    return int(x > 0) - int(x < 0)


def _step(x: Enclosure, *_: Any) -> Enclosure:
    return iv.mpf([1 if x.a > 0 else 0, 0 if x.b < 0 else 1])


def _add(*parts: Enclosure) -> Enclosure:
    return reduce(lambda x, y: x + y, parts)


def _multiply_all(*parts: Enclosure) -> Enclosure:
    return reduce(multiply, parts)


def _enclose_minimum(*parts: Enclosure) -> Enclosure:
    return iv.mpf([min(p.a for p in parts), min(p.b for p in parts)])


def _largest(*parts: Enclosure) -> Enclosure:
    return iv.mpf([max(p.a for p in parts), max(p.b for p in parts)])


def _pieces(*parts: Any) -> Enclosure:
    """The hull of the pieces whose condition can be the first that is true."""
    reached: list[Enclosure] = []
    for value, (can_be_true, can_be_false) in zip(parts[::2], parts[1::2], strict=True):
        if can_be_true:
            reached.append(value)
        if not can_be_false:
            return _hull(*reached)
    return WHOLE  # undefined where no condition is true


def _compare_below(x: Enclosure, y: Enclosure) -> Possible:
    return bool(x.a < y.b), bool(x.b >= y.a)


def _compare_not_above(x: Enclosure, y: Enclosure) -> Possible:
    return bool(x.a <= y.b), bool(x.b > y.a)


def _compare_equal(x: Enclosure, y: Enclosure) -> Possible:
    return bool(x.a <= y.b and y.a <= x.b), not (x.a == x.b == y.a == y.b)


def _negate(x: Possible) -> Possible:
    return x[1], x[0]


def _if(condition: Possible, one: Possible, other: Possible) -> Possible:
    if_true, if_false = condition
    return if_true and one[0] or if_false and other[0], if_true and one[1] or if_false and other[1]


_OPERATIONS: Mapping[Any, Callable[..., Any]] = {
    sp.Add: _add,
    sp.Mul: _multiply_all,
    sp.exp: _exponential,
    sp.sin: lambda x: _enclose_sine(iv.sin(x)),
    sp.cos: lambda x: _enclose_sine(iv.cos(x)),
    sp.tanh: lambda x: _enclose_sine(_enclose_rising(libmp.mpf_tanh)(x)),
    sp.atan: _enclose_rising(libmp.mpf_atan),
    sp.sinh: lambda x: (_exponential(x) - _exponential(-x)) / 2,
    sp.cosh: lambda x: (_exponential(abs(x)) + _exponential(-abs(x))) / 2,
    sp.Abs: abs,
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
    sp.Unequality: lambda x, y: _negate(_compare_equal(x, y)),
    sp.And: lambda *all_of: (all(x[0] for x in all_of), any(x[1] for x in all_of)),
    sp.Or: lambda *any_of: (any(x[0] for x in any_of), all(x[1] for x in any_of)),
    sp.Not: _negate,
    sp.ITE: _if,
}

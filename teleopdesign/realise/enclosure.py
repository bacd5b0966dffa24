"""Interval enclosure of a law: bounds of its value over ranges of its symbols.

An interval is the set of real numbers between its two ends. Its ends may be infinite, but no number
of it is: zero times an unbounded interval is zero. Inside, ends are numbers of mpmath with 53 bits,
rounded outward by its interval arithmetic; they do not overflow. Where a law is not defined, as a
logarithm of a negative number, its interval is the whole line.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from math import inf, nextafter
from operator import or_
from typing import Any

import sympy as sp
from mpmath import libmp
from mpmath.libmp import finf, fninf, fone, from_float, fzero, libmpi, mpf_le, mpf_lt, mpf_sign

from ..base.errors import ModelError

#: ends of an interval
Enclosure = tuple[float, float]
#: the same in mpmath's numbers
_Ends = tuple[Any, Any]
#: whether a condition can be true, and whether it can be false
Possible = tuple[bool, bool]

BITS = 53
_WHOLE, _ZERO, _ONE = (fninf, finf), (fzero, fzero), (fone, fone)
_HALF, _WAVE = (libmp.fhalf, libmp.fhalf), (libmp.fnone, fone)
#: arguments of an exponential beyond which it exceeds all floats, or is next to zero; and of a sine
#: or cosine, beyond which it may have any value
_EXPONENTS = (from_float(-1e3), from_float(1e3))
_FARTHEST = from_float(1e300)
#: factor of four units in the last place: mpmath rounds some functions of tiny arguments to the
#: wrong side by one unit, as atan(9e-17) to its argument
_GUARD = (from_float(1 - 2.0**-50), from_float(1 + 2.0**-50))


def enclosure_of(
    law: sp.Expr, variables: Sequence[sp.Symbol]
) -> Callable[[Sequence[Enclosure]], Enclosure]:
    """The law as a function of one interval for each variable.

    The function keeps its last values: parts whose variables are as before are not computed anew.

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
            steps.append((places[node], depends[-1], _operation(node), arguments))
        return places[node]

    last = place(sp.sympify(law))
    known: list[Enclosure | None] = [None] * len(variables)
    values: list[Any] = [None] * len(depends)
    changed = 2 * constant - 1

    def evaluate(enclosures: Sequence[Enclosure]) -> Enclosure:
        nonlocal changed
        for i, enclosure in enumerate(enclosures):
            if known[i] != enclosure:
                known[i] = enclosure
                values[i] = from_float(enclosure[0]), from_float(enclosure[1])
                changed |= 1 << i
        for at, depend, operation, arguments in steps:
            if depend & changed:
                values[at] = operation(*[values[i] for i in arguments])
        changed = 0
        return _in_floats(values[last])

    return evaluate


def _in_floats(x: _Ends) -> Enclosure:
    """The interval in floats on its outer sides."""
    below, above = map(libmp.to_float, x)
    # conversion rounds to the nearest float, to zero or infinity beyond the range of floats
    if mpf_lt(x[0], from_float(below)):
        below = nextafter(below, -inf)
    if mpf_lt(from_float(above), x[1]):
        above = nextafter(above, inf)
    return below, above


def _arguments(node: sp.Basic) -> tuple[sp.Basic, ...]:
    if isinstance(node, sp.Piecewise):
        return tuple(part for pair in node.args for part in (pair.expr, pair.cond))
    if isinstance(node, sp.Pow) and node.exp.is_Rational:
        return (node.base,)
    return () if node.is_Atom else node.args


def _operation(node: sp.Basic) -> Callable[..., Any]:
    """The operation of a node of the law on the intervals, or possibilities, of its arguments."""
    if node in (sp.true, sp.false):
        return lambda: (node == sp.true, node == sp.false)
    if node.is_Atom:
        constant = _constant(node)
        return lambda: constant
    if isinstance(node, sp.Pow):
        return _power(node)
    operation = _OPERATIONS.get(node.func)
    if operation is None:
        raise ModelError(f"no guaranteed bound: none is known of {node.func.__name__}(...)")
    return operation


def _constant(node: sp.Basic) -> _Ends:
    if isinstance(node, sp.Float):
        return _both_ways(libmp.mpf_pos, node._mpf_)
    if isinstance(node, sp.Rational) and node.is_finite:
        return _both_ways(libmp.from_rational, node.p, node.q)
    if node in (sp.pi, sp.E):
        return _both_ways(libmp.mpf_pi if node == sp.pi else libmp.mpf_e)
    raise ModelError(f"no guaranteed bound: none is known of {node}")


def _both_ways(function: Callable[..., Any], *arguments: Any) -> _Ends:
    """A number of mpmath, rounded down and up."""
    low, high = (
        function(*arguments, BITS, way) for way in (libmp.round_floor, libmp.round_ceiling)
    )
    return low, high


def _add(*parts: _Ends) -> _Ends:
    return reduce(lambda x, y: libmpi.mpi_add(x, y, BITS), parts)


def _multiply(*parts: _Ends) -> _Ends:
    return _ZERO if _ZERO in parts else reduce(lambda x, y: libmpi.mpi_mul(x, y, BITS), parts)


def _reciprocal(x: _Ends) -> _Ends:
    inverse: _Ends = libmpi.mpi_div(_ONE, x, BITS)
    return inverse


def _power(node: sp.Pow) -> Callable[..., _Ends]:
    exponent = node.exp
    if not exponent.is_Rational:
        if node.base == sp.E:
            return lambda _, y: _exponential(y)
        return lambda x, y: _exponential(_multiply(y, _logarithm(x)))
    whole, root = abs(int(exponent.p)), int(exponent.q)

    def power(x: _Ends) -> _Ends:
        if root != 1:
            if mpf_sign(x[0]) < 0:
                return _WHOLE
            x = libmpi.mpi_sqrt(x, BITS) if root == 2 else _root(x, root)
        x = libmpi.mpi_pow_int(x, whole, BITS)
        return _reciprocal(x) if exponent < 0 else x

    return power


def _root(x: _Ends, root: int) -> _Ends:
    """The root of an interval that is not negative."""
    power = _exponential(_multiply(_logarithm(x), _both_ways(libmp.from_rational, 1, root)))
    return _hull(_ZERO, power) if x[0] == fzero else power


def _logarithm(x: _Ends) -> _Ends:
    if mpf_sign(x[0]) < 0 or mpf_sign(x[1]) <= 0:
        return _WHOLE
    return _rising(libmp.mpf_log, x)


def _exponential(x: _Ends) -> _Ends:
    low, high = (libmpi.MIN(libmpi.MAX(end, _EXPONENTS[0]), _EXPONENTS[1]) for end in x)
    low, high = _rising(libmp.mpf_exp, (low, high))
    low = fzero if mpf_lt(x[0], _EXPONENTS[0]) else low
    high = finf if mpf_lt(_EXPONENTS[1], x[1]) else high
    least, most = fone if mpf_sign(x[0]) >= 0 else fzero, fone if mpf_sign(x[1]) <= 0 else finf
    return _limit((low, high), (least, most))


def _exponentials(x: _Ends) -> tuple[_Ends, _Ends]:
    """e^x and e^-x."""
    return _exponential(x), _exponential(libmpi.mpi_neg(x))


def _rising(function: Callable[[Any, int, str], Any], x: _Ends) -> _Ends:
    """The interval of an increasing function of mpmath, from its values at both ends."""
    ends = function(x[0], BITS, libmp.round_floor), function(x[1], BITS, libmp.round_ceiling)
    return _multiply(ends, _GUARD)


def _limit(x: _Ends, within: _Ends) -> _Ends:
    """The interval without what lies beyond bounds that are known of its values."""
    return libmpi.MAX(x[0], within[0]), libmpi.MIN(x[1], within[1])


def _wave(function: Callable[[Any, int], Any], x: _Ends) -> _Ends:
    """The range of a sine or cosine of mpmath's intervals."""
    if not all(mpf_le(libmp.mpf_abs(end), _FARTHEST) for end in x):
        return _WAVE
    return _limit(_multiply(function(x, BITS), _GUARD), _WAVE)


def _sign(x: _Ends) -> _Ends:
    low, high = (libmp.from_int(mpf_sign(end)) for end in x)
    return low, high


def _step(x: _Ends, *_: Any) -> _Ends:
    return fone if mpf_sign(x[0]) > 0 else fzero, fzero if mpf_sign(x[1]) < 0 else fone


def _of_ends(of_low: Callable[..., Any], of_high: Callable[..., Any], *parts: _Ends) -> _Ends:
    """The interval whose low end is made of the low ends of all parts, its high end of the high."""
    lows, highs = zip(*parts, strict=True)
    return reduce(of_low, lows), reduce(of_high, highs)


#: the smallest interval that holds some intervals
_hull = partial(_of_ends, libmpi.MIN, libmpi.MAX)


def _pieces(*parts: Any) -> _Ends:
    """The hull of the pieces whose condition can be the first that is true."""
    reached: list[_Ends] = []
    for value, (can_be_true, can_be_false) in zip(parts[::2], parts[1::2], strict=True):
        if can_be_true:
            reached.append(value)
        if not can_be_false:
            return _hull(*reached)
    return _WHOLE  # undefined where no condition is true


def _compare_below(x: _Ends, y: _Ends) -> Possible:
    return mpf_lt(x[0], y[1]), mpf_le(y[0], x[1])


def _compare_equal(x: _Ends, y: _Ends) -> Possible:
    return mpf_le(x[0], y[1]) and mpf_le(y[0], x[1]), not (x[0] == x[1] == y[0] == y[1])


def _refute(x: Possible) -> Possible:
    return x[1], x[0]


def _if(condition: Possible, one: Possible, other: Possible) -> Possible:
    if_true, if_false = condition
    return if_true and one[0] or if_false and other[0], if_true and one[1] or if_false and other[1]


_OPERATIONS: Mapping[Any, Callable[..., Any]] = {
    sp.Add: _add,
    sp.Mul: _multiply,
    sp.exp: _exponential,
    sp.log: _logarithm,
    sp.sin: partial(_wave, libmpi.mpi_sin),
    sp.cos: partial(_wave, libmpi.mpi_cos),
    sp.tan: lambda x: _multiply(_wave(libmpi.mpi_sin, x), _reciprocal(_wave(libmpi.mpi_cos, x))),
    sp.tanh: lambda x: _limit(_rising(libmp.mpf_tanh, x), _WAVE),
    sp.atan: partial(_rising, libmp.mpf_atan),
    sp.sinh: lambda x: _multiply(_HALF, libmpi.mpi_sub(*_exponentials(x), BITS)),
    sp.cosh: lambda x: _multiply(_HALF, _add(*_exponentials(libmpi.mpi_abs(x)))),
    sp.Abs: libmpi.mpi_abs,
    sp.sign: _sign,
    sp.Heaviside: _step,
    sp.Min: partial(_of_ends, libmpi.MIN, libmpi.MIN),
    sp.Max: partial(_of_ends, libmpi.MAX, libmpi.MAX),
    sp.Piecewise: _pieces,
    sp.StrictLessThan: _compare_below,
    sp.StrictGreaterThan: lambda x, y: _compare_below(y, x),
    sp.LessThan: lambda x, y: _refute(_compare_below(y, x)),
    sp.GreaterThan: lambda x, y: _refute(_compare_below(x, y)),
    sp.Equality: _compare_equal,
    sp.Unequality: lambda x, y: _refute(_compare_equal(x, y)),
    sp.And: lambda *all_of: (all(x[0] for x in all_of), any(x[1] for x in all_of)),
    sp.Or: lambda *any_of: (any(x[0] for x in any_of), all(x[1] for x in any_of)),
    sp.Not: _refute,
    sp.ITE: _if,
}

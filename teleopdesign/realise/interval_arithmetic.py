"""Interval arithmetic in floats, rounded outward.

An interval is the set of real numbers between its two ends. Its ends may be infinite, but no number
of it is: zero times an unbounded interval is zero. A float operation rounds to the nearest float.
The error of a sum or product is a float, too (Knuth, The Art of Computer Programming, volume 2,
section 4.2.2; Dekker, Numerische Mathematik 18, 1971), and its sign tells on which side the exact
result lies. Functions are those of mpmath, rounded outward at 53 bits.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from math import inf, isinf, nextafter
from typing import Any

from mpmath import libmp

Enclosure = tuple[float, float]
#: a function of mpmath on its own numbers: (number, bits, rounding) -> number
RoundedFunction = Callable[[Any, int, str], Any]

WHOLE: Enclosure = (-inf, inf)
ZERO: Enclosure = (0.0, 0.0)
ONE: Enclosure = (1.0, 1.0)
BITS = 53
_LARGEST, _SMALLEST = sys.float_info.max, 5e-324
#: factors between these have products whose error is a float, and so has each part of the error
_LEAST, _MOST = 1e-120, 1e120
#: splits a float into two halves of 26 bits
_SPLIT = 2.0**27 + 1.0
#: factor of four units in the last place: mpmath rounds some functions of tiny arguments to the
#: wrong side by one unit, as atan(9e-17) to its argument
_GUARD: Enclosure = (1 - 2.0**-50, 1 + 2.0**-50)


def _next_to(rounded: float, error: float) -> Enclosure:
    """The floats on either side of rounded + error; NaN: the error is unknown."""
    low = rounded if error >= 0.0 else nextafter(rounded, -inf)
    return low, rounded if error <= 0.0 else nextafter(rounded, inf)


def _outside_floats(sign: float) -> Enclosure:
    """Where a finite number lies that is beyond all floats."""
    return (_LARGEST, inf) if sign > 0 else (-inf, -_LARGEST)


def _split(a: float) -> tuple[float, float]:
    c = _SPLIT * a
    high = c - (c - a)
    return high, a - high


def _product_error(a: float, b: float, product: float) -> float:
    """a b - product, exactly, of factors between `_LEAST` and `_MOST`."""
    (ah, al), (bh, bl) = _split(a), _split(b)
    return ((ah * bh - product) + ah * bl + al * bh) + al * bl


def _is_usual(a: float) -> bool:
    return _LEAST < abs(a) < _MOST


def add_floats(a: float, b: float) -> Enclosure:
    """The floats on either side of a + b, both equal where it is a float."""
    s = a + b
    if isinf(s):
        return (s, s) if isinf(a) or isinf(b) else _outside_floats(s)
    v = s - a
    return _next_to(s, (a - (s - v)) + (b - v))


def multiply_floats(a: float, b: float) -> Enclosure:
    """The floats on either side of a b, both equal where it is a float; 0 times anything is 0."""
    if a == 0.0 or b == 0.0:
        return ZERO
    p = a * b
    if isinf(p):
        return (p, p) if isinf(a) or isinf(b) else _outside_floats(p)
    if abs(a) == 1.0 or abs(b) == 1.0:
        return p, p
    if _is_usual(a) and _is_usual(b):
        return _next_to(p, _product_error(a, b, p))
    if p == 0.0:
        return (0.0, _SMALLEST) if (a > 0) == (b > 0) else (-_SMALLEST, 0.0)
    return nextafter(p, -inf), nextafter(p, inf)


def _invert_float(a: float) -> Enclosure:
    """The floats on either side of 1/a, a not zero; of an infinite end, zero."""
    r = 1.0 / a
    if isinf(r):
        return _outside_floats(r)
    if isinf(a):
        return ZERO
    if not (_is_usual(a) and _is_usual(r)):
        return nextafter(r, -inf), nextafter(r, inf)
    p = r * a
    more = (p - 1.0) + _product_error(r, a, p)  # r a - 1
    return _next_to(r, -more if a > 0 else more)


def add(x: Enclosure, y: Enclosure) -> Enclosure:
    """Sum of two intervals."""
    return add_floats(x[0], y[0])[0], add_floats(x[1], y[1])[1]


def negate(x: Enclosure) -> Enclosure:
    """The interval turned round zero."""
    return -x[1], -x[0]


def absolute(x: Enclosure) -> Enclosure:
    """The absolute values of the numbers of an interval."""
    low, high = x
    if low >= 0.0:
        return x
    return negate(x) if high <= 0.0 else (0.0, max(-low, high))


def multiply(x: Enclosure, y: Enclosure) -> Enclosure:
    """Product of two intervals."""
    if x[0] < 0.0 <= y[0]:
        x, y = y, x
    if x[0] < 0.0:
        parts = [multiply_floats(a, b) for a in x for b in y]
        return min(p[0] for p in parts), max(p[1] for p in parts)
    # x is not negative: which of its ends counts follows from the sign of each end of y
    below, above = x[0] if y[0] >= 0.0 else x[1], x[1] if y[1] >= 0.0 else x[0]
    return multiply_floats(below, y[0])[0], multiply_floats(above, y[1])[1]


def reciprocal(x: Enclosure) -> Enclosure:
    """1/x; the whole line where zero lies within, or is the only number."""
    low, high = x
    if low < 0.0 < high or low == high == 0.0:
        return WHOLE
    least = -inf if high == 0.0 else _invert_float(high)[0]
    return least, inf if low == 0.0 else _invert_float(low)[1]


def power(x: Enclosure, whole: int) -> Enclosure:
    """A whole power, at least 1, of an interval."""
    if whole % 2 == 0:
        x = absolute(x)
    if x[0] >= 0.0:
        return _power_of_positive(x, whole)
    if x[1] <= 0.0:
        return negate(_power_of_positive(negate(x), whole))
    below, above = ((0.0, end) for end in (-x[0], x[1]))
    return -_power_of_positive(below, whole)[1], _power_of_positive(above, whole)[1]


def _power_of_positive(x: Enclosure, whole: int) -> Enclosure:
    result, factor = ONE, x
    while whole:
        if whole & 1:
            result = multiply(result, factor)
        whole >>= 1
        if whole:
            factor = multiply(factor, factor)
    return result


def hull(*parts: Enclosure) -> Enclosure:
    """The smallest interval that holds these."""
    return min(p[0] for p in parts), max(p[1] for p in parts)


def outward(low: Any, high: Any) -> Enclosure:
    """The interval between two numbers of mpmath, in floats on their outer sides."""
    below, above = libmp.to_float(low), libmp.to_float(high)
    # conversion rounds to the nearest float, to zero or infinity beyond the range of floats
    if libmp.mpf_gt(libmp.from_float(below), low):
        below = nextafter(below, -inf)
    if libmp.mpf_lt(libmp.from_float(above), high):
        above = nextafter(above, inf)
    return below, above


def constant(function: Callable[[int, str], Any]) -> Enclosure:
    """A constant of mpmath: (bits, rounding) -> number."""
    return outward(function(BITS, libmp.round_floor), function(BITS, libmp.round_ceiling))


def enclose_rising(function: RoundedFunction, x: Enclosure) -> Enclosure:
    """The interval of an increasing function, from its values at both ends."""
    low, high = (libmp.from_float(end) for end in x)
    ends = function(low, BITS, libmp.round_floor), function(high, BITS, libmp.round_ceiling)
    return multiply(outward(*ends), _GUARD)


def enclose_wave(function: Callable[[Any, int], Any], x: Enclosure) -> Enclosure:
    """The range of a sine or cosine of mpmath's intervals."""
    ends = function((libmp.from_float(x[0]), libmp.from_float(x[1])), BITS)
    return limit(multiply(outward(*ends), _GUARD), -1.0, 1.0)


def limit(x: Enclosure, least: float, most: float) -> Enclosure:
    """The interval without what lies beyond bounds that are known of its values."""
    return max(x[0], least), min(x[1], most)

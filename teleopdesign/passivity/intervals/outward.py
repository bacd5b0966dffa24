"""Arrays of intervals of floats, rounded outward, so that each contains the true value.

A sum, a difference, a product and a square root of floats are rounded to the nearest float (IEEE
754). So the two neighbours of a result enclose the true value. If a number is too large for a
float, an end is infinite or NaN. No comparison with NaN holds, so nothing is shown then. Sine and
cosine are sums of their series, for the angle less its nearest multiple of a quarter turn; no
library computes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial, isinf
from typing import Any

import numpy as np

#: terms of the series of sine and cosine, for |x| <= 1: the rest is at most 1/22!, below _LEFT_OUT
_TERMS = 11
_LEFT_OUT = 1e-21
#: n times this bounds the relative error of a sum of n floats: each step is rounded by 2^-53
_UNIT = 2.0**-52


@dataclass(frozen=True, eq=False)
class Outward:
    """An array of intervals; low, high: their ends, arrays of one shape."""

    low: np.ndarray
    high: np.ndarray

    @classmethod
    def exactly(cls, values: np.ndarray) -> Outward:
        """Floats as intervals without width."""
        return cls(values, values)

    @classmethod
    def about(cls, values: Iterable[Fraction]) -> Outward:
        """The narrowest intervals that enclose rational numbers, (n,)."""
        ends = [_enclose(x) for x in values]
        low, high = np.array(ends, dtype=float).reshape(-1, 2).T
        return cls(low, high)

    @classmethod
    def about_pairs(cls, pairs: Iterable[tuple[Fraction, Fraction]]) -> Outward:
        """Intervals with rational ends, (n,)."""
        ends = list(pairs)
        return cls(cls.about(a for a, _ in ends).low, cls.about(b for _, b in ends).high)

    def __getitem__(self, at: Any) -> Outward:
        return Outward(self.low[at], self.high[at])

    def __neg__(self) -> Outward:
        return Outward(-self.high, -self.low)

    def __add__(self, other: Outward) -> Outward:
        return Outward(next_below(self.low + other.low), next_above(self.high + other.high))

    def __sub__(self, other: Outward) -> Outward:
        return self + -other

    def __mul__(self, other: Outward) -> Outward:
        first, second = self.low * other.low, self.low * other.high
        third, fourth = self.high * other.low, self.high * other.high
        least = np.minimum(np.minimum(first, second), np.minimum(third, fourth))
        most = np.maximum(np.maximum(first, second), np.maximum(third, fourth))
        return Outward(next_below(least), next_above(most))

    def widen(self, by: np.ndarray) -> Outward:
        """The intervals with both ends moved outward by that much, >= 0."""
        return Outward(next_below(self.low - by), next_above(self.high + by))

    def total(self) -> Outward:
        """Intervals of the sums over the last axis."""
        return Outward(-sum_above(-self.low), sum_above(self.high))

    def largest(self) -> np.ndarray:
        """Largest absolute value in each interval."""
        return np.asarray(np.maximum(np.abs(self.low), np.abs(self.high)))

    def smallest(self) -> np.ndarray:
        """Smallest absolute value in each interval."""
        return np.asarray(np.maximum(np.maximum(self.low, -self.high), 0.0))

    def middle(self) -> tuple[np.ndarray, np.ndarray]:
        """A float inside each interval, and a bound of its distance from both ends."""
        at = self.low + (self.high - self.low) / 2
        return at, next_above(np.maximum(next_above(self.high - at), next_above(at - self.low)))


def next_below(x: np.ndarray) -> np.ndarray:
    """The next smaller floats."""
    return np.asarray(np.nextafter(x, -np.inf))


def next_above(x: np.ndarray) -> np.ndarray:
    """The next larger floats."""
    return np.asarray(np.nextafter(x, np.inf))


def sum_above(x: np.ndarray) -> np.ndarray:
    """Upper bounds of the sums of floats over the last axis, for any order of summation."""
    wrong = (x.shape[-1] + 2) * _UNIT * np.abs(x).sum(axis=-1)
    return next_above(x.sum(axis=-1) + next_above(wrong))


def stack(parts: Sequence[Outward]) -> Outward:
    """The arrays of intervals joined along a new last axis."""
    return Outward(
        np.stack([p.low for p in parts], axis=-1), np.stack([p.high for p in parts], axis=-1)
    )


def least_size(real: Outward, imaginary: Outward) -> np.ndarray:
    """Lower bounds of the absolute values of all complex numbers in these intervals."""
    a, b = real.smallest(), imaginary.smallest()
    square = np.maximum(next_below(next_below(a * a) + next_below(b * b)), 0.0)
    return np.asarray(np.maximum(next_below(np.sqrt(square)), 0.0))


def most_size(real: Outward, imaginary: Outward) -> np.ndarray:
    """Upper bounds of the absolute values of all complex numbers in these intervals."""
    a, b = real.largest(), imaginary.largest()
    return next_above(np.sqrt(next_above(next_above(a * a) + next_above(b * b))))


def cosine_and_sine(angle: Outward) -> tuple[Outward, Outward]:
    """Intervals of the cosine and the sine of angles (rad), from their series.

    The series are for the angle less its nearest multiple of a quarter turn.
    """
    at, spread = angle.middle()
    quarters = np.rint(at * (2 / np.pi))
    rest, more = (Outward.exactly(at) - Outward.exactly(quarters) * _QUARTER).middle()
    wrong = next_above(next_above(spread + more) + _LEFT_OUT)
    x = Outward.exactly(rest)
    square = x * x
    known = np.abs(rest) <= 1.0  # else: an angle that is not known to a quarter turn
    cosine = _hold(_series(square, 0).widen(wrong), known)
    sine = _hold((x * _series(square, 1)).widen(wrong), known)
    return _turn_further(cosine, sine, np.mod(quarters, 4.0))


def _turn_further(cosine: Outward, sine: Outward, quarters: np.ndarray) -> tuple[Outward, Outward]:
    """Cosine and sine of the angle plus 0, 1, 2 or 3 quarter turns."""
    turns = [(cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine)]
    which = [quarters == k for k in range(4)]
    first, second = (
        Outward(
            np.select(which, [one[i].low for one in turns], -1.0),
            np.select(which, [one[i].high for one in turns], 1.0),
        )
        for i in (0, 1)
    )
    return first, second


def _series(square: Outward, first: int) -> Outward:
    """Sum of (-square)^k/(2 k + first)!, by Horner's scheme."""
    total = Outward.exactly(np.zeros_like(square.low))
    for k in reversed(range(_TERMS)):
        total = Outward.about([Fraction((-1) ** k, factorial(2 * k + first))]) + square * total
    return total


def _hold(value: Outward, known: np.ndarray) -> Outward:
    """The intervals limited to -1..1; where `known` is False they are -1..1."""
    low, high = np.maximum(value.low, -1.0), np.minimum(value.high, 1.0)
    return Outward(np.where(known, low, -1.0), np.where(known, high, 1.0))


def _enclose(value: Fraction) -> tuple[float, float]:
    try:
        nearest = float(value)
    except OverflowError:
        return (-np.inf, -np.finfo(float).max) if value < 0 else (np.finfo(float).max, np.inf)
    if isinf(nearest) or Fraction(nearest) == value:
        return nearest, nearest
    if Fraction(nearest) < value:
        return nearest, float(np.nextafter(nearest, np.inf))
    return float(np.nextafter(nearest, -np.inf)), nearest


#: a quarter turn: pi/2 = 1.5707963267948966192... lies between this float and the next one
_QUARTER = Outward(np.array(1.5707963267948966), np.nextafter(np.array(1.5707963267948966), np.inf))

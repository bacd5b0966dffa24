"""Bounds of what a checker reads and computes, and the refusal of what exceeds them.

The functions of `polynomials.py` serve a proof (bounded) and a search (not bounded): what they may
spend stands in the context that `bounded` opens, not in their arguments.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from fractions import Fraction

#: bounds of what is read (bytes, digits, names, signs, brackets) and computed (degree, bits, and
#: products of terms, some microseconds each): above all the package writes, a few seconds at most
FILE, DIGITS, NAMES, SIGNS, NESTING = 2_000_000, 4000, 60, 4, 40
DEGREE, BITS, EFFORT = 4000, 100_000, 1_500_000

#: effort that is left, in a list of one; None: not bounded
_LEFT: ContextVar[list[int] | None] = ContextVar("_LEFT", default=None)


class Refused(ValueError):
    """What was read proves nothing; the message is one line."""


def need(condition: object, problem: str) -> None:
    """Refuse with that problem unless the condition holds."""
    if not condition:
        raise Refused(f"refused: {problem[:200]}")


@contextmanager
def bound_effort(left: list[int]) -> Iterator[None]:
    """Within it polynomials spend from `left`, a list of one number, and are refused below 0."""
    token = _LEFT.set(left)
    try:
        yield
    finally:
        _LEFT.reset(token)


def spend_from(left: list[int], effort: int) -> None:
    """Take the effort from what is left; Refused where that is not enough."""
    left[0] -= effort
    need(left[0] >= 0, "more work than a certificate may ask for")


def longest(numbers: Iterable[Fraction]) -> int:
    """Bits of the longest number; Refused above BITS."""
    parts = (max(abs(x.numerator), x.denominator).bit_length() for x in numbers)
    most = max(parts, default=0)
    need(most <= BITS, "a number is too long")
    return most


def spend(times: int, a: Iterable[Fraction], b: Iterable[Fraction]) -> None:
    """Take so many products of numbers of a and b from what is left, where that is bounded.

    Each costs 1, and quadratically more in the length of long numbers
    """
    left = _LEFT.get()
    if left is not None:
        spend_from(left, 1 + times * (1 + (longest(a) * longest(b) >> 17)))

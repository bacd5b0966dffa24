"""Bounds of what the checker reads and computes, and the refusal of what exceeds these bounds.

The functions of `polynomials.py` serve a proof, whose effort is bounded, and a search, whose effort
is not. So the effort is no argument of these functions: `bound_effort` opens a context with it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from fractions import Fraction

#: bounds of what is read: bytes of a file, digits of a number, characters of a name and names of
#: one kind, signed quantities, nested brackets. They lie above everything that the package writes
FILE, DIGITS, NAMES, SIGNS, NESTING = 2_000_000, 4000, 60, 4, 40
#: bounds of what is computed: degree of a polynomial, bits of a number, and products of terms (some
#: microseconds each, so a few seconds at most)
DEGREE, BITS, EFFORT = 4000, 100_000, 1_500_000

#: effort that is left, in a list of one number, which all functions share; None: not bounded
_LEFT: ContextVar[list[int] | None] = ContextVar("_LEFT", default=None)


class Refused(ValueError):
    """A certificate proves nothing; the message is one line that says why."""


def need(condition: object, problem: str) -> None:
    """Raise Refused with a text of the problem, unless the condition holds."""
    if not condition:
        raise Refused(f"refused: {problem[:200]}")


@contextmanager
def bound_effort(left: list[int]) -> Iterator[None]:
    """A context in which polynomials take effort from `left`, a list of one number, or refuse."""
    token = _LEFT.set(left)
    try:
        yield
    finally:
        _LEFT.reset(token)


def spend_from(left: list[int], effort: int) -> None:
    """Subtract the effort from `left`, a list of one number; raises Refused below 0."""
    left[0] -= effort
    need(left[0] >= 0, "more work than a certificate may ask for")


def longest(numbers: Iterable[Fraction]) -> int:
    """Bits of the longest numerator or denominator among the numbers; raises Refused above BITS."""
    parts = (max(abs(x.numerator), x.denominator).bit_length() for x in numbers)
    most = max(parts, default=0)
    need(most <= BITS, "a number is too long")
    return most


def spend(times: int, a: Iterable[Fraction], b: Iterable[Fraction]) -> None:
    """Subtract the effort of `times` products of numbers of a and b, where effort is bounded.

    A product of short numbers costs 1, of long ones it grows with the product of their lengths.
    """
    left = _LEFT.get()
    if left is not None:
        spend_from(left, 1 + times * (1 + (longest(a) * longest(b) >> 17)))

"""Bounds of what the checker reads and computes, and the refusal of what exceeds these bounds."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

#: bounds of what is read: bytes of a file, digits of a number, characters of a name and names of
#: one kind, signed quantities, nested brackets. They lie above everything that the package writes
FILE, DIGITS, NAMES, SIGNS, NESTING = 2_000_000, 4000, 60, 4, 40
#: bounds of what is computed: degree of a polynomial, bits of a number, and products of terms (some
#: microseconds each, so a few seconds at most)
DEGREE, BITS, EFFORT = 4000, 100_000, 1_500_000


class Refused(ValueError):
    """A certificate proves nothing; the message is one line that says why."""


def need(condition: object, problem: str) -> None:
    """Raise Refused with a text of the problem, unless the condition holds."""
    if not condition:
        raise Refused(f"refused: {problem[:200]}")


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


def spend(left: list[int], times: int, a: Iterable[Fraction], b: Iterable[Fraction]) -> None:
    """Subtract the effort of `times` products of numbers of a and b from `left`.

    A product of short numbers costs 1, of long ones it grows with the product of their lengths.
    """
    spend_from(left, 1 + times * (1 + (longest(a) * longest(b) >> 17)))

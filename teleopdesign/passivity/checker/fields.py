"""Read the fields of a certificate: types, names, numbers and texts; a wrong one is refused."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

from .algebra import Algebra, Quotient
from .effort import DIGITS, EFFORT, NAMES, need

_NUMBER = re.compile(r"-?\d+(/0*[1-9]\d*)?", re.ASCII)


def expect(kind: type, value: Any, what: str) -> Any:
    """The value, if it is exactly of that type; else raises Refused. what: name in the message."""
    need(type(value) is kind, f"{what}: expected {kind.__name__}, found {type(value).__name__}")
    return value


def read_words(value: Any, what: str) -> list[str]:
    """A list of names: plain ASCII words, each once, at most NAMES of them; else raises Refused."""
    names: list[str] = expect(list, value, what)
    for n in names:
        fits = type(n) is str and len(n) <= NAMES and re.fullmatch(r"[A-Za-z]\w*", n, re.ASCII)
        need(fits and "__" not in n, f"{what}: a name that is no plain word")
    need(len(set(names)) == len(names) <= NAMES, f"{what}: a name twice, or too many")
    return names


def read_number(text: Any, what: str) -> Fraction:
    """The number of a text such as "-1/2"; raises Refused for any other text."""
    fits = type(text) is str and len(text) <= DIGITS and _NUMBER.fullmatch(text)
    need(fits, f"{what}: expected a fraction such as -1/2")
    return Fraction(text)


def expect_fields(c: dict[str, Any], *names: str) -> None:
    """Raise Refused for a certificate that has not exactly these fields."""
    need({*c} == {*names}, f"expected exactly the fields {', '.join(sorted(names))}")


def flat(text: str) -> str:
    """The text on one line."""
    return " ".join(text.split())


def read_matrix(value: Any, sizes: tuple[int, ...]) -> tuple[Algebra, list[list[Quotient]], str]:
    """Read a square matrix of texts: the algebra in s, the entries, and a text for a statement.

    sizes: numbers of rows that are allowed;  raises Refused: another matrix
    """
    rows = [expect(list, row, "impedance") for row in expect(list, value, "impedance")]
    shape = " or ".join(f"{n}x{n}" for n in sizes)
    fits = len(rows) in sizes and all(len(row) == len(rows) for row in rows)
    need(fits, f"impedance: not {shape}")
    algebra = Algebra(["s"], [EFFORT], divides=True)
    z = [[algebra.read(e) for e in row] for row in rows]
    return algebra, z, ", ".join("[" + ", ".join(map(flat, row)) + "]" for row in rows)

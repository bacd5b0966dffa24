"""A drawing as a short list of shapes, which an SVG writer and a matplotlib painter both render.

Lengths are in points, x points to the right, y points down.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

SheetPoint = tuple[float, float]
#: "block": name of a block, "signal": name of a signal, "sign": at a junction, "law": in a box
TextRole = Literal["block", "signal", "sign", "law"]
SIZES: dict[TextRole, float] = {"block": 11.0, "signal": 10.0, "sign": 10.0, "law": 7.0}
SMALLER = 0.72  # size of an index against that of its letter


@dataclass(frozen=True)
class Box:
    """A block, given by its centre; with the block name "", a bar that gathers signals."""

    x: float
    y: float
    width: float
    height: float
    block: str


@dataclass(frozen=True)
class Circle:
    """A summing junction."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class Wire:
    """One way of a signal along horizontal and vertical lines;  arrow: at the last point.

    signal: key of the signal, unique for each signal, also for wires without a name
    """

    points: tuple[SheetPoint, ...]
    signal: str
    arrow: bool = True


@dataclass(frozen=True)
class Dot:
    """The point at which a wire branches off another wire of the same signal."""

    x: float
    y: float


@dataclass(frozen=True)
class Run:
    """Characters of one style.

    level: 0 on the line, -1 an index, 1 an exponent
    """

    text: str
    level: int
    italic: bool


@dataclass(frozen=True)
class Text:
    """A text, with y at the middle of its letters.

    anchor: the part of the text that lies at x
    """

    x: float
    y: float
    runs: tuple[Run, ...]
    role: TextRole
    anchor: Literal["start", "middle", "end"] = "middle"

    @property
    def plain(self) -> str:
        """The characters without their style."""
        return "".join(run.text for run in self.runs)

    @property
    def width(self) -> float:
        """Estimated width (points), on the safe side for the font of the house style."""
        return width(self.runs, self.role)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, top, right and bottom edge (points)."""
        start = {"start": 0.0, "middle": -0.5, "end": -1.0}[self.anchor] * self.width
        half = 0.5 * SIZES[self.role]
        return self.x + start, self.y - half, self.x + start + self.width, self.y + half


SheetShape = Box | Circle | Wire | Dot | Text


def symbol(name: str) -> tuple[Run, ...]:
    """A name as papers write it: R_FF with FF as its index, single letters in italics."""
    name = readable(name)
    head, _, index = name.partition("_")
    if not head or not index:
        return (Run(name, 0, _is_letter(name)),)
    return Run(head, 0, _is_letter(head)), Run(index.replace("_", " "), -1, _is_letter(index))


def readable(text: str) -> str:
    """The text with "?" for characters that cannot be printed; XML may not contain some of them."""
    return "".join(c if c.isprintable() else "?" for c in text)


def _is_letter(text: str) -> bool:
    return re.fullmatch(r"[^\W\d_]\d?", text) is not None


def width(runs: tuple[Run, ...], role: TextRole) -> float:
    """Estimated width of a text (points), for a font like Times."""
    return sum(
        SIZES[role] * (SMALLER if run.level else 1.0) * sum(map(_em, run.text)) for run in runs
    )


def _em(character: str) -> float:
    if character in "ijl.,:;|!'()[] ":
        return 0.34
    if character in "mwMW":
        return 0.92
    return 0.74 if character.isupper() or ord(character) > 0x2000 else 0.53

"""A drawing as a short list of shapes, which matplotlib paints.

Lengths are in points, x points to the right, y points down.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cache
from typing import Literal

RADIUS = 7.0
BAR = (4.0, 24.0)  # width and height of a bar
MINUS = "\u2212"


@dataclass(frozen=True)
class Node:
    """One part of a drawing: a box, a circle, a bar, a name or the end of an arrow.

    kind: "box"; "sum", a circle; "bar", which gathers signals; "source", a name where a signal
        comes from outside; "sink", the end of an arrow
    title, notes: text in the node, and the lines below it
    moving: a body whose motion a path of the drawing ends with
    driver: an input that drives a body; the layout begins at other inputs if there are any
    """

    name: str
    kind: Literal["box", "sum", "bar", "source", "sink"]
    title: tuple[Run, ...] = ()
    notes: tuple[str, ...] = ()
    moving: bool = False
    driver: bool = False

    @property
    def size(self) -> tuple[float, float]:
        """Width and height (points)."""
        if self.kind == "sum":
            return 2 * RADIUS, 2 * RADIUS
        if self.kind == "bar":
            return BAR
        if self.kind == "sink":
            return 0.0, 0.0
        if self.kind == "source":
            return width(self.title, "signal") + 4.0, 13.0
        notes = [width((Run(n, 0, False),), "law") for n in self.notes]
        wide = max(34.0, width(self.title, "block") + 14.0, *(n + 10.0 for n in notes), 0.0)
        return wide, 28.0 + 8.5 * len(self.notes)


@dataclass
class Net:
    """Wires from one node to others;  targets: (node, weight in its sum, 1 for other nodes)."""

    name: str
    source: str
    signals: list[str]
    targets: list[tuple[str, float]] = field(default_factory=list)


@dataclass
class Network:
    """Nodes and nets by name, in the order of the diagram."""

    nodes: dict[str, Node] = field(default_factory=dict)
    nets: dict[str, Net] = field(default_factory=dict)

    def following(self, node: str) -> list[str]:
        """Nodes that the output of `node` leads to."""
        return [t for net in self.nets.values() if net.source == node for t, _ in net.targets]

    def count_incoming(self, node: str) -> int:
        """Number of wires that lead to a node."""
        return sum(t == node for net in self.nets.values() for t, _ in net.targets)

    def net_of(self, node: str) -> Net | None:
        """The net of a node's output; None for a node without one."""
        return next((n for n in self.nets.values() if n.source == node), None)


def join_names(signals: list[str]) -> tuple[Run, ...]:
    """The names of one net as a text: R_D = R_A."""
    runs: tuple[Run, ...] = symbol(signals[0])
    for signal in signals[1:]:
        runs = (*runs, Run(" = ", 0, False), *symbol(signal))
    return runs


def label(net: Net) -> tuple[Run, ...]:
    """The text on the wire of a net; empty for a net without a name."""
    return join_names(net.signals) if net.signals else ()


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
        """Width (points)."""
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
    """Width of a text (points)."""
    return sum(run_width(run, SIZES[role]) for run in runs)


#: both come with matplotlib, so that widths are the same everywhere; the second has more letters
FONT = ["STIXGeneral", "DejaVu Sans"]


@cache
def run_width(run: Run, size: float) -> float:
    """Width of characters in the font (points), including the space after the last letter."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(family=FONT, style="italic" if run.italic else "normal")
    scale = size * (SMALLER if run.level else 1.0)

    def wide(text: str) -> float:
        return float(text_to_path.get_text_width_height_descent(text, font, ismath=False)[0])

    # between two strokes, so that spaces at the ends count
    return (wide(f"|{run.text}|") - wide("||")) * scale / font.get_size_in_points()


ARROW = (6.0, 2.2)  # length, half width
#: how far below its middle the line on which letters stand lies, in sizes
BASELINE = 0.32
RAISED = {0: 0.0, -1: 0.22, 1: -0.38}


def shaft(wire: Wire) -> tuple[SheetPoint, ...]:
    """The points of a wire's line; under an arrow it ends before the tip, which stays sharp."""
    if not wire.arrow:
        return wire.points
    tip, left, right = arrow_head(wire)
    foot = (left[0] + right[0]) / 2, (left[1] + right[1]) / 2
    return *wire.points[:-1], ((tip[0] + foot[0]) / 2, (tip[1] + foot[1]) / 2)


def arrow_head(wire: Wire) -> tuple[tuple[float, float], ...]:
    """The corners of the arrow head at the wire's last point, tip first."""
    (x0, y0), (x, y) = wire.points[-2:]
    length = abs(x - x0) + abs(y - y0)  # along one axis
    dx, dy = (x - x0) / length, (y - y0) / length
    back, half = ARROW
    foot = x - back * dx, y - back * dy
    return (
        (x, y),
        (foot[0] - half * dy, foot[1] + half * dx),
        (foot[0] + half * dy, foot[1] - half * dx),
    )

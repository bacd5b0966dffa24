"""The parts of a drawn diagram: nodes, and nets of wires that join them; no places yet."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from .shapes import Run, symbol, width

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

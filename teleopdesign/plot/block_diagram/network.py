"""A diagram as what is drawn: nodes, and the nets of wires that join them; no places yet.

A body that forces move is a sum of its forces and a box with its inverse impedance. A junction of
one signal, taken as it is, is no node: its net carries both names.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from ...blocks import Body
from ...controllers import Controller
from ...derive import has_actuation
from ...diagrams import Attached, Control, Diagram, Moving
from ...diagrams.wiring import Block
from .shapes import Run, symbol, width

MOST_AT_A_SUM = 3  # inputs of a circle: from behind, from above, from below
RADIUS = 7.0
MINUS = "\u2212"


@dataclass(frozen=True)
class Node:
    """A box, a circle, a name where a signal comes from outside, or the end of an arrow.

    moving: a body whose motion the diagram ends with;  driver: last choice of where to begin
    """

    name: str
    kind: Literal["box", "sum", "source", "sink"]
    title: tuple[Run, ...] = ()
    notes: tuple[str, ...] = ()
    moving: bool = False
    driver: bool = False

    @property
    def size(self) -> tuple[float, float]:
        """Width and height, points."""
        if self.kind == "sum":
            return 2 * RADIUS, 2 * RADIUS
        if self.kind == "sink":
            return 0.0, 0.0
        if self.kind == "source":
            return width(self.title, "signal") + 4.0, 13.0
        notes = [width((Run(n, 0, False),), "law") for n in self.notes]
        wide = max(34.0, width(self.title, "block") + 14.0, *(n + 10.0 for n in notes), 0.0)
        return wide, 28.0 + 8.5 * len(self.notes)


@dataclass
class Net:
    """Wires from one node to others;  targets: (node, weight in its sum, 1 elsewhere)."""

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
        """Nodes that the output of a node goes to."""
        return [t for net in self.nets.values() if net.source == node for t, _ in net.targets]

    def net_of(self, node: str) -> Net | None:
        """The net that a node makes."""
        return next((n for n in self.nets.values() if n.source == node), None)


def network(diagram: Diagram) -> Network:
    """The nodes and nets of a diagram."""
    made = Network()
    same = _same_signals(diagram)
    drivers = {b.driver for b in diagram.blocks if isinstance(b, Moving)}

    def wire(source: str, signal: str = "", name: str = "") -> None:
        names = [signal, *(s for s in diagram.signals if s != signal and same.get(s) == signal)]
        key = name or f"signal {signal}"
        made.nets[key] = Net(key, source, names if signal else [])

    for signal in diagram.outside:
        title = _joined([signal, *(s for s, o in same.items() if o == signal)])
        made.nodes[f"from {signal}"] = Node(
            f"from {signal}", "source", title, driver=signal in drivers
        )
        wire(f"from {signal}", signal)
    for block in diagram.blocks:
        moving = isinstance(block, Moving)
        title = _title(block)
        made.nodes[_box(block)] = Node(_box(block), "box", title, _notes(block), moving=moving)
        wire(_box(block), block.outputs[0])
    wants: list[tuple[str, str, float]] = []  # node, net, weight

    def nets(terms: Mapping[str, float]) -> list[tuple[str, float]]:
        return [(f"signal {same.get(s, s)}", float(w)) for s, w in terms.items()]

    for block in diagram.blocks:
        if not isinstance(block, Moving):
            taken = block.motion if isinstance(block, Attached) else block.input
            wants.append((_box(block), *nets({taken: 1.0})[0]))
            continue
        ((command, _),) = nets({block.command: 1.0})
        if has_actuation(block):
            stage = f"A_{block.name}"
            own = tuple(e.name for e in getattr(block.body, "effects", ()) if e.role == "actuation")
            made.nodes[f"stage {stage}"] = Node(f"stage {stage}", "box", symbol(stage), _said(own))
            wants.append((f"stage {stage}", command, 1.0))
            command = f"acting on {block.name}"
            wire(f"stage {stage}", name=command)
        terms = [(command, 1.0), *nets(block.loads)]
        if len(terms) == 1:
            wants.append((_box(block), command, 1.0))
        else:
            total = f"forces on {block.name}"
            wire(total, name=total)
            wants += [*_sum(made, total, terms), (_box(block), total, 1.0)]
    for junction in diagram.junctions:
        if junction.output in same:
            continue
        wire(junction.name, junction.output)
        wants += _sum(made, junction.name, nets(junction.terms))
    for node, name, weight in wants:
        made.nets[name].targets.append((node, weight))
    for net in made.nets.values():
        if not net.targets:
            made.nodes[f"to {net.name}"] = Node(f"to {net.name}", "sink")
            net.targets.append((f"to {net.name}", 1.0))
    return made


def _same_signals(diagram: Diagram) -> dict[str, str]:
    """Output of a junction that only passes a signal on -> the signal it passes on."""
    passed = {
        j.output: next(iter(j.terms))
        for j in diagram.junctions
        if len(j.terms) == 1 and next(iter(j.terms.values())) == 1
    }
    found = {}
    for output in passed:
        origin, seen = output, set()
        while origin in passed and origin not in seen:
            seen.add(origin)
            origin = passed[origin]
        if origin not in passed:  # else signals that only pass each other on, in a ring
            found[output] = origin
    return found


def _box(block: Block) -> str:
    return f"block {block.name}"


def _sum(made: Network, name: str, terms: list[tuple[str, float]]) -> list[tuple[str, str, float]]:
    """A circle for the sum, or several in series where there are more terms than sides."""
    made.nodes[name] = Node(name, "sum")
    if len(terms) <= MOST_AT_A_SUM:
        return [(name, net, weight) for net, weight in terms]
    part = f"part of {name}"
    made.nets[part] = Net(part, part, [])
    own = [(name, part, 1.0), *((name, net, weight) for net, weight in terms[-2:])]
    return [*_sum(made, part, terms[:-2]), *own]


def _title(block: Block) -> tuple[Run, ...]:
    if isinstance(block, Moving):
        return *symbol(block.name), Run(f"{MINUS}1", 1, False)
    if isinstance(block, Attached) and block.sign < 0:
        return Run(MINUS, 0, False), *symbol(block.name)
    return symbol(block.name)


def _notes(block: Block) -> tuple[str, ...]:
    if isinstance(block, Control):
        if not isinstance(block.controller, Controller):
            return ()
        return _said(tuple(stage.law.name for stage in block.controller.stages))
    if not isinstance(block.body, Body):
        return ()
    return _said(("inertia", *(e.name for e in block.body.effects if e.role != "actuation")))


def _said(names: tuple[str, ...]) -> tuple[str, ...]:
    shown = [n.replace("_", " ") for n in names]
    return tuple(shown) if len(shown) <= 4 else (*shown[:3], f"{len(shown) - 3} more")


def _joined(signals: list[str]) -> tuple[Run, ...]:
    """Names of one net: R_D = R_A."""
    runs: tuple[Run, ...] = symbol(signals[0])
    for signal in signals[1:]:
        runs = (*runs, Run(" = ", 0, False), *symbol(signal))
    return runs


def label(net: Net) -> tuple[Run, ...]:
    """What is written on the wire of a net; empty where it has no name."""
    return _joined(net.signals) if net.signals else ()

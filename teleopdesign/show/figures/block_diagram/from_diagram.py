"""The nodes and nets that are drawn for a diagram.

A body that forces move is a sum of its forces and a box with its inverse impedance. A junction that
passes one signal on unchanged is no node: its net carries both names. A matrix is a box for each
row. A box with more than three inputs gets the further signals through bars before it.

Formulas as a few short lines in a box.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import sympy as sp
from sympy.printing.str import StrPrinter

from ....blocks import Body
from ....derive import has_actuation
from ....diagrams import Attached, Block, Control, Diagram, Junction, Kinematics, Linked, Moving
from ....diagrams.junctions import Weight
from .shapes import MINUS, Net, Network, Node, Run, join_names, symbol

#: characters of a line, and lines of a box; what is longer is not shown
LONGEST, MOST = 34, 4


class _Printer(StrPrinter):
    """Prints formulas as people write them: numbers have four digits."""

    def _print_Float(self, expr: sp.Float) -> str:
        return f"{float(expr):.4g}"


def formula(expression: sp.Expr, *, short: str) -> tuple[str, ...]:
    """The expression on lines of its terms; `short` if these lines are too long or too many."""
    terms = sp.Add.make_args(sp.sympify(expression, strict=True))
    lines: list[str] = []
    for term in sorted(terms, key=sp.default_sort_key):
        text = str(_Printer().doprint(term)).replace("**", "^").replace("*", " ")
        text = text.replace("-", MINUS)
        text = text if not lines or text.startswith(MINUS) else f"+ {text}"
        if lines and len(lines[-1]) + len(text) < LONGEST:
            lines[-1] += f" {text}"
        else:
            lines.append(text)
    readable = len(lines) <= MOST and all(len(line) <= LONGEST for line in lines)
    return tuple(lines) if readable else (short,)


MOST_INPUTS = 3  # most inputs of a circle, a box, a bar: from behind, from above, from below


def network(diagram: Diagram) -> Network:
    """The nodes and nets of a diagram."""
    making = _Making(diagram, _same_signals(diagram))
    making.sources()
    for block in diagram.blocks:
        if isinstance(block, Linked):
            making.rows(block)
        else:
            making.box(block)
    for block in diagram.blocks:
        if isinstance(block, Moving):
            making.forces(block)
        elif not isinstance(block, Linked):
            source = block.motion if isinstance(block, Attached) else block.input
            making.join(making.net(source), _box(block))
    for kinematics in diagram.kinematics:
        making.kinematics(kinematics)
    for junction in diagram.junctions:
        if junction.output not in making.same:
            making.junction(junction)
    making.ends()
    return making.made


@dataclass
class _Making:
    """A network under construction;  same: signal -> the signal that it only passes on."""

    diagram: Diagram
    same: Mapping[str, str]
    made: Network = field(default_factory=Network)
    wants: list[tuple[str, str, float]] = field(default_factory=list)

    def net(self, signal: str) -> str:
        """Name of the net that carries a signal."""
        return f"signal {self.same.get(signal, signal)}"

    def nets(self, terms: Mapping[str, float]) -> list[tuple[str, float]]:
        return [(self.net(signal), float(weight)) for signal, weight in terms.items()]

    def join(self, net: str, node: str, weight: float = 1.0) -> None:
        """Note that a net leads to a node; `ends` makes the wires when all nets exist."""
        self.wants.append((net, node, weight))

    def wire(self, node: str, signal: str = "") -> None:
        """Make the net from a node: of a signal and its other names, or of the node alone."""
        key = self.net(signal) if signal else node
        self.made.nets[key] = Net(key, node, self.names(signal) if signal else [])

    def names(self, signal: str) -> list[str]:
        return [signal, *(s for s in self.diagram.signals if self.same.get(s) == signal)]

    def sources(self) -> None:
        drivers = {b.driver for b in self.diagram.moving}
        for signal in self.diagram.outside:
            name, title = f"from {signal}", join_names(self.names(signal))
            self.made.nodes[name] = Node(name, "source", title, driver=signal in drivers)
            self.wire(name, signal)

    def box(self, block: Moving | Attached | Control) -> None:
        name, moving = _box(block), isinstance(block, Moving)
        self.made.nodes[name] = Node(name, "box", _title(block), _notes(block), moving=moving)
        self.wire(name, block.outputs[0])

    def rows(self, block: Linked) -> None:
        """A box for each row of a matrix, fed by the motions that the row depends on."""
        title = (Run(MINUS, 0, False),) if block.sign < 0 else ()
        for i, force in enumerate(block.forces):
            row, read = f"row {i + 1}", [j for k, j in block.entries if k == i]
            name = f"{_box(block)} {row}"
            self.made.nodes[name] = Node(
                name, "box", (*title, *symbol(block.name)), (row, *_kinds(block, i))
            )
            self.wire(name, force)
            self.gather(name, [self.net(s) for s in _drop_repeats(block.motions[j] for j in read)])

    def kinematics(self, part: Kinematics) -> None:
        name = f"block {part.name}"
        label = formula(sp.sympify(part.expression, strict=True), short="kinematics")
        self.made.nodes[name] = Node(name, "box", symbol(part.output), label)
        self.wire(name, part.output)
        self.gather(name, [self.net(s) for s in part.inputs])

    def junction(self, part: Junction) -> None:
        """A circle; weights that depend on positions are a box before it or in its place."""
        fixed = {s: float(w) for s, w in part.terms.items() if not _depends(w)}
        terms = self.nets(fixed)
        if len(fixed) < len(part.terms):
            box = self.lever_arms(part, signal="" if fixed else part.output)
            if not fixed:
                return
            terms = [(box, 1.0), *terms]
        self.wire(part.name, part.output)
        self.sum(part.name, terms)

    def lever_arms(self, part: Junction, signal: str) -> str:
        """Make a box for the terms whose weights depend on positions; returns the name of its net.

        signal: the output of the box; "": the box is the first term of a circle
        """
        levered = {s: w for s, w in part.terms.items() if _depends(w)}
        name = f"block lever arms of {part.output}"
        whole = sp.Add(*(w * sp.Symbol(s, real=True) for s, w in levered.items()))
        label = formula(sp.expand_mul(whole), short=f"lever arms of {', '.join(part.arms)}")
        self.made.nodes[name] = Node(name, "box", symbol(part.output), label)
        self.wire(name, signal)
        self.gather(name, [self.net(s) for s in levered])
        return name

    def gather(self, node: str, nets: list[str]) -> None:
        """Lead nets to a box, through bars if there are more nets than sides."""
        if len(nets) > MOST_INPUTS:
            bar = f"bar before {node}"
            self.made.nodes[bar] = Node(bar, "bar")
            self.wire(bar)
            self.gather(bar, nets[: -(MOST_INPUTS - 1)])
            nets = [bar, *nets[-(MOST_INPUTS - 1) :]]
        for net in nets:
            self.join(net, node)

    def forces(self, block: Moving) -> None:
        """The forces on a body: its command, through its actuation, and its loads."""
        command = self.net(block.command)
        if has_actuation(block):
            stage = f"stage A_{block.name}"
            effects = block.body.effects if isinstance(block.body, Body) else ()
            notes = _shorten_names(tuple(e.name for e in effects if e.role == "actuation"))
            self.made.nodes[stage] = Node(stage, "box", symbol(f"A_{block.name}"), notes)
            self.join(command, stage)
            self.wire(stage)
            command = stage
        if not block.loads:
            self.join(command, _box(block))
            return
        total = f"forces on {block.name}"
        self.wire(total)
        self.sum(total, [(command, 1.0), *self.nets(block.loads)])
        self.join(total, _box(block))

    def sum(self, name: str, terms: list[tuple[str, float]]) -> None:
        """A circle, or several circles in series if there are more terms than sides."""
        self.made.nodes[name] = Node(name, "sum")
        if len(terms) > MOST_INPUTS:
            part = f"part of {name}"
            self.wire(part)
            self.sum(part, terms[:-2])
            terms = [(part, 1.0), *terms[-2:]]
        for net, weight in terms:
            self.join(net, name, weight)

    def ends(self) -> None:
        """Lead every net to its targets; a net without a target gets the end of an arrow."""
        for net, node, weight in self.wants:
            self.made.nets[net].targets.append((node, weight))
        for one in self.made.nets.values():
            if not one.targets:
                name = f"to {one.name}"
                self.made.nodes[name] = Node(name, "sink")
                one.targets.append((name, 1.0))


def _same_signals(diagram: Diagram) -> dict[str, str]:
    """Output of a junction that only passes a signal on -> the first signal of that chain."""
    passed = {
        j.output: next(iter(j.terms))
        for j in diagram.junctions
        if len(j.terms) == 1 and not j.arms and next(iter(j.terms.values())) == 1
    }
    origins = {}
    for output in passed:
        origin, visited = output, set()
        while origin in passed and origin not in visited:
            visited.add(origin)
            origin = passed[origin]
        if origin not in passed:  # else signals that only pass each other on, in a ring
            origins[output] = origin
    return origins


def _box(block: Block) -> str:
    return f"block {block.name}"


def _depends(weight: Weight) -> bool:
    """Whether a weight depends on positions."""
    return bool(sp.sympify(weight, strict=True).free_symbols)


def _drop_repeats(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))


def _kinds(block: Linked, row: int) -> tuple[str, ...]:
    """Names of the matrices that have an entry in that row (rows are counted from 0)."""
    start = f"_{row + 1}_"
    return tuple(_drop_repeats(n.partition("_")[0] for n in block.body.parameters if start in n))


def _title(block: Block) -> tuple[Run, ...]:
    if isinstance(block, Moving):
        return *symbol(block.name), Run(f"{MINUS}1", 1, False)
    if isinstance(block, Attached) and block.sign < 0:
        return Run(MINUS, 0, False), *symbol(block.name)
    if _is_delay(block):
        # the block's name is that of its dead time: e^(-s T_1), index and all in the exponent
        late = (Run(run.text, 1, run.italic) for run in symbol(block.name))
        return Run("e", 0, False), Run(MINUS, 1, False), Run("s", 1, True), *late
    return symbol(block.name)


def _is_delay(block: Block) -> bool:
    return isinstance(block, Control) and block.dead_time is not None


def _notes(block: Block) -> tuple[str, ...]:
    if isinstance(block, Control):
        laws = () if _is_delay(block) else (stage.law.name for stage in block.stages)
        return _shorten_names(tuple(laws))
    if not isinstance(block.body, Body):
        return ()
    return _shorten_names(
        ("inertia", *(e.name for e in block.body.effects if e.role != "actuation"))
    )


def _shorten_names(names: tuple[str, ...]) -> tuple[str, ...]:
    shown = [n.replace("_", " ") for n in names]
    return tuple(shown) if len(shown) <= 4 else (*shown[:3], f"{len(shown) - 3} more")

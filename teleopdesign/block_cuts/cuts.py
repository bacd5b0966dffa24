"""Cuts of a diagram, from its wiring alone: which recorded signal tests which blocks.

A recorded signal that a block or a junction makes cuts the diagram. Upstream of the cut, other
recorded signals are known inputs. The prediction of the signal from them is compared with the
record, so the cut tests the blocks between.

Effects may be one and the same at a cut of several blocks, whatever the records hold. Where the
command is not recorded, what acts on it in the computer and in the actuator is the same. Where the
force of the hand is not recorded, device and hand move together: their forces only show as a sum.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Literal

from ..diagrams import ANY, Attached, Control, Diagram, Junction, Linked, Moving
from ..diagrams.parts import Part
from ..effects import Effect

#: place of an effect that acts on the whole command
COMPUTER = "computer"


@dataclass(frozen=True)
class Cut:
    """One recorded signal and the blocks that make it of other recorded signals.

    name: of its error: the signal of a computer's force, the block of a body
    kind: "computer": forces that a computer makes;  "body": a body, or a body that is held;
        "wiring": a junction all of whose terms are recorded
    blocks: that it tests, with `COMPUTER` where the signal is a command
    inputs: recorded signals of which it is predicted
    separating: signals whose recording would test its blocks one by one
    """

    name: str
    signal: str
    kind: Literal["computer", "body", "wiring"]
    blocks: tuple[str, ...]
    inputs: tuple[str, ...]
    separating: tuple[str, ...] = ()

    def __str__(self) -> str:
        what = ", ".join(self.blocks) or "the wiring"
        return f"cut {self.name}: {self.signal} from {', '.join(self.inputs)} tests {what}"


@dataclass(frozen=True)
class Cuts:
    """All cuts of a diagram;  untested: block -> why no cut tests it."""

    tested: tuple[Cut, ...]
    untested: Mapping[str, str]

    def of(self, kind: str) -> tuple[Cut, ...]:
        """The cuts of one kind."""
        return tuple(cut for cut in self.tested if cut.kind == kind)

    def __repr__(self) -> str:
        lines = []
        for cut in self.tested:
            lines.append(str(cut))
            if cut.separating:
                lines.append(f"    to tell them apart: record {', '.join(cut.separating)}")
        lines += [f"untested: {block}: {why}" for block, why in self.untested.items()]
        return "\n".join(lines)


def cuts_of(diagram: Diagram, recorded: Collection[str], zero: Collection[str] = ()) -> Cuts:
    """The cuts of a diagram.

    recorded: names of recorded signals;  zero: outside signals that are known to be zero
    """
    known = {*recorded, *zero}
    tested: list[Cut] = []
    reasons: dict[str, str] = {}
    for signal in recorded:
        if signal in diagram.outside:
            continue
        made = _trace(diagram, signal, known)
        cut = _cut(diagram, signal, made, recorded)
        if isinstance(cut, Cut):
            tested.append(cut)
        else:
            reasons |= {p.name: cut for p in made.blocks if p.name not in reasons}
    done = {name for cut in tested for name in cut.blocks}
    names = [block.name for block in diagram.blocks if block.name not in done]
    untested = {n: reasons.get(n) or _why_untested(diagram, n, recorded) for n in names}
    return Cuts(tuple(tested), untested)


@dataclass
class _Traced:
    """What makes a signal of known ones: blocks, known signals and unknown outside ones."""

    blocks: list[Part]
    inputs: list[str]
    unknown: list[str]


def _trace(diagram: Diagram, signal: str, known: Collection[str]) -> _Traced:
    makers = {s: part for part in diagram.parts for s in part.outputs}
    made, todo, visited = _Traced([], [], []), [makers[signal]], set()
    while todo:
        part = todo.pop(0)
        if part.name in visited:
            continue
        visited.add(part.name)
        if isinstance(part, Moving | Attached | Linked | Control):
            made.blocks.append(part)
        for s in part.inputs:
            if s in known:
                made.inputs += [s] if s not in made.inputs else []
            elif s in diagram.outside:
                made.unknown.append(s)
            else:
                todo.append(makers[s])
    return made


def _cut(diagram: Diagram, signal: str, made: _Traced, recorded: Collection[str]) -> Cut | str:
    """The cut at a signal, or why there is none."""
    if made.unknown:
        lacks = made.unknown[0]
        return f"{lacks} is neither recorded nor zero: record {lacks}, or state it as zero"
    if unstated := [b.name for b in made.blocks if _content(b) is ANY]:
        return f"{unstated[0]} has no values to compare"
    if analog := [b.name for b in made.blocks if isinstance(b, Control) and b.analog]:
        return f"{analog[0]} is analog: only laws in a computer are predicted"
    if blind := next((s for b in made.blocks for s in _unread(diagram, b, recorded)), None):
        return f"the computer reads {blind}, which is not recorded: record {blind}"
    bodies = [b for b in made.blocks if isinstance(b, Moving | Attached | Linked)]
    controls = [b for b in made.blocks if isinstance(b, Control)]
    inputs = tuple(s for s in made.inputs if s in recorded)
    inside = {s for b in made.blocks for s in b.outputs} - {signal}
    inside |= {j.output for j in diagram.junctions if inside & set(j.terms)} - {signal, *recorded}
    separating = tuple(s for s in diagram.signals if s in inside) if len(made.blocks) > 1 else ()
    names = tuple(b.name for b in diagram.blocks if b in made.blocks)
    if not bodies:
        if not controls:
            return Cut(signal, signal, "wiring", (), inputs)
        commands = {b.command for b in diagram.moving}
        whole = (COMPUTER,) if signal in commands else ()
        return Cut(signal, signal, "computer", (*names, *whole), inputs, separating)
    moving = [b for b in bodies if isinstance(b, Moving)]
    if any(isinstance(b, Linked) for b in bodies):
        return "an impedance matrix has no force residual yet"
    if any(b.motion != signal for b in moving):
        lacks = next(b.motion for b in moving if b.motion != signal)
        return f"the motion {lacks} is not recorded: record {lacks}"
    if not moving and (controls or len(bodies) > 1):
        return f"it is tested only with others: record {', '.join(separating)}"
    if any(isinstance(b, Attached) and b.motion != signal for b in bodies if moving):
        return "it is attached to a motion that is not recorded"
    name = moving[0].name if moving else bodies[0].name
    whole = (COMPUTER,) if controls else ()
    return Cut(name, signal, "body", (*names, *whole), inputs, separating)


def _unread(diagram: Diagram, block: Part, recorded: Collection[str]) -> list[str]:
    """Measured signals that a controller needs and that no record holds."""
    if not isinstance(block, Control):
        return []
    behind = [_trace(diagram, s, recorded) for s in block.inputs if s not in recorded]
    made = {
        s for one in behind for b in one.blocks if not isinstance(b, Control) for s in b.outputs
    }
    made |= {j.output for j in diagram.junctions if made & set(j.terms)}
    return [s for s in diagram.measured if s in made and s not in recorded]


def _content(block: Part) -> object:
    return block.controller if isinstance(block, Control) else getattr(block, "body", None)


def _why_untested(diagram: Diagram, name: str, recorded: Collection[str]) -> str:
    """Why no recorded signal tests a block: none follows from it, or only through others."""
    block = diagram.block(name)
    behind = [j.output for j in diagram.junctions if set(block.outputs) & set(j.terms)]
    wanted = [s for s in (*block.outputs, *behind) if s not in recorded]
    return f"no recorded signal follows from it: record {' or '.join(wanted) or 'its output'}"


#: effect of a body's actuation -> the effect of the computer that does the same to the command
_OF_COMMAND = {
    "actuator_gain": "gain",
    "actuation_delay": "delay",
    "actuator_lag": "lag",
    "actuator_saturation": "saturation",
    "actuator_dead_zone": "dead_zone",
    "bias": "bias",
}
#: roles of effects that a hand may have as well: those of a force between body and surroundings
OF_A_HAND = ("force", "friction_level", "friction_shape", "friction_factor")


def same_effects(diagram: Diagram, cut: Cut, effect: Effect) -> tuple[tuple[str, str], ...]:
    """(name, place) of effects at other places of a body's cut that no record tells from this one.

    effect: of the body that gives the cut its name
    """
    same = []
    if COMPUTER in cut.blocks and effect.name in _OF_COMMAND:
        name = _OF_COMMAND[effect.name]
        places = [COMPUTER]
        if name == "bias":
            places += [b for b in feeding(diagram, cut) if b in cut.blocks]
        same += [(name, at) for at in places]
    if effect.role in OF_A_HAND:
        others = [n for n in cut.blocks if n != cut.name and diagram.has(n)]
        bodies = [n for n in others if not isinstance(diagram.block(n), Control)]
        same += [(effect.name, at) for at in bodies]
    return tuple(same)


def feeding(diagram: Diagram, cut: Cut) -> list[str]:
    """Controllers whose outputs are terms of the command of a cut."""
    block = diagram.block(cut.name)
    assert isinstance(block, Moving)
    makers = {s: part for part in diagram.parts for s in part.outputs}
    command = makers.get(block.command)
    terms = command.terms if isinstance(command, Junction) else {}
    return [makers[s].name for s in terms if isinstance(makers.get(s), Control)]

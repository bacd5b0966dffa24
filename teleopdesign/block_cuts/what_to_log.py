"""What must be logged: from a diagram alone, before any recording."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from ..base.arguments import check_types
from ..base.units import unit_of
from ..diagrams import Diagram
from .cuts import Cuts, cuts_of
from .diagram_experiment import axis_of


@dataclass(frozen=True)
class LoggedSignal:
    """A signal that is worth a column;  needed: without it a block stays untested or in a group."""

    name: str
    text: str
    needed: bool


@dataclass(frozen=True)
class LoggingPlan:
    """Signals to log in each pass of the computer, and the cuts that they make.

    zero: outside signals that must be zero during the recording, because no sensor reads them
    """

    diagram: Diagram
    signals: tuple[LoggedSignal, ...]
    zero: tuple[str, ...]
    cuts: Cuts

    @property
    def code(self) -> str:
        """Lines of C that write a row at the end of a pass, from variables of these names."""
        names = [one.name for one in self.signals]
        head = ",".join(["t", *names])
        row = ",".join(["%.6f", *(["%.9g"] * len(names))])
        return (
            f'fprintf(file, "{head}\\n");  /* once */\n'
            f'fprintf(file, "{row}\\n",  /* at the end of each pass */\n'
            f"        {', '.join(['t', *names])});"
        )

    @property
    def channels(self) -> str:
        """The tables [diagram] and [channels] of an experiment of such a log."""
        lines = ["[diagram]", 'file = "interface.toml"', "one_pass = true"]
        if self.zero:
            lines += ["[diagram.outside]", *(f'"{name}" = 0' for name in self.zero)]
        lines += ["[channels]", 'time = { column = "t", unit = "s" }']
        for one in self.signals:
            motion = self.diagram.is_position(one.name)
            motion |= self.diagram.outside.get(one.name) == "position"
            quantity = "position" if motion else "force"
            unit = unit_of(quantity, axis_of(self.diagram, one.name))
            lines.append(f'"{one.name}" = {{ column = "{one.name}", unit = "{unit}" }}')
        return "\n".join(lines)

    def __repr__(self) -> str:
        lines = [f"To log in each pass of the computer of {self.diagram.name}:"]
        for one in self.signals:
            lines.append(
                f"  {one.name:<6} {one.text}{'' if one.needed else ' (tells blocks apart)'}"
            )
        lines += [f"  {name:<6} must be zero: no sensor reads it" for name in self.zero]
        lines += ["", *repr(self.cuts).splitlines(), "", self.code, "", self.channels]
        return "\n".join(lines)


@check_types
def what_to_log(diagram: Diagram) -> LoggingPlan:
    """The signals whose recording tests every block of a diagram, as far as one can record them.

    Signals that a sensor reads, the computer makes, or a force sensor at a body would read. What no
    sensor reads alone, such as the voluntary force of a hand, must be zero where a block needs it.
    """
    bodies = diagram.moving
    controls = diagram.controls
    at_bodies = [s for b in bodies for s in (b.motion, b.command, *b.loads)]
    read = _sources(diagram, [s for b in controls for s in b.inputs] + [b.command for b in bodies])
    needed = [*(s for s in diagram.outside if s in read and s not in at_bodies), *at_bodies]
    apart = [s for b in controls for s in b.outputs]
    names = tuple(dict.fromkeys((*needed, *apart)))
    zero = zero_signals(diagram, names, names)
    signals = tuple(LoggedSignal(n, diagram.texts.get(n, n), n in needed) for n in names)
    return LoggingPlan(diagram, signals, zero, cuts_of(diagram, names, zero))


def zero_signals(
    diagram: Diagram, recorded: Collection[str], sensed: Collection[str]
) -> tuple[str, ...]:
    """Signals from outside that must be zero so that the recorded ones test what they can.

    sensed: signals that a sensor or the computer could give, which are not taken to be zero
    """
    zero = tuple(s for s in diagram.outside if s not in sensed)
    for name in zero:  # a force that no block needs may have any value
        fewer = tuple(s for s in zero if s != name)
        untested = [len(cuts_of(diagram, recorded, some).untested) for some in (fewer, zero)]
        if untested[0] == untested[1]:
            zero = fewer
    return zero


def _sources(diagram: Diagram, signals: Sequence[str]) -> set[str]:
    """Signals from which these are made by sums alone, those of sensors left out."""
    junctions = {j.output: j for j in diagram.junctions}
    sources: set[str] = set()
    todo = list(signals)
    while todo:
        name = todo.pop()
        if name in sources or name in diagram.measured:
            continue
        sources.add(name)
        todo += list(junctions[name].terms) if name in junctions else []
    return sources

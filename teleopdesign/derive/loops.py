"""Loops of a diagram, as the names of their signals."""

from __future__ import annotations

from collections.abc import Mapping

from ..diagrams import Control, Diagram, Part
from ..diagrams.second_input import acts_along_another


def loop_of(diagram: Diagram, signal: str) -> tuple[str, ...]:
    """The shortest loop through a signal, preferably of junctions alone; () if there is none."""
    for parts in (diagram.junctions, diagram.parts):
        makers = {s: part for part in parts for s in part.outputs}
        before: dict[str, str] = {}
        reached = [signal]
        for at in reached:
            part = makers.get(at)
            for source in () if part is None else _inputs_of(diagram, part):
                if source == signal:
                    return _path_back(before, at, signal)
                if source not in before:
                    before[source] = at
                    reached.append(source)
    return ()


def _inputs_of(diagram: Diagram, part: Part) -> tuple[str, ...]:
    if isinstance(part, Control) and not acts_along_another(diagram, part):
        return (part.input,)  # the motion only sets where the law is frozen
    return part.inputs


def _path_back(before: Mapping[str, str], at: str, signal: str) -> tuple[str, ...]:
    """The loop in the direction of the wires; the search ran in the other direction."""
    way = [at]
    while way[-1] != signal:
        way.append(before[way[-1]])
    return (signal, *way[:-1])

"""The computer's part of a diagram: what lies between sensors and commands."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import sympy as sp

from ..diagrams import Attached, Control, Diagram, Junction, Linked, Moving
from ..errors import ModelError


@dataclass(frozen=True)
class ComputerEquations:
    """The sampled part: states before and after their step over one sample, and the signals.

    rates: continuous rates, inputs held over a sample;  before: states stepped ahead of the output
    steps: value at the next sample, for states that state it in place of a rate
    late: symbol -> (expression, delay), of what it keeps for later samples
    """

    rates: Mapping[sp.Symbol, sp.Expr]
    steps: Mapping[sp.Symbol, sp.Expr]
    before: frozenset[sp.Symbol]
    signals: Mapping[str, sp.Expr]
    late: Mapping[sp.Symbol, tuple[sp.Expr, sp.Expr]] = field(default_factory=dict)


def sensor_signals(diagram: Diagram) -> set[str]:
    """Signals that the computer has from a sensor; those from outside it knows anyway."""
    return set(diagram.measured) - set(diagram.outside)


def computer_signals(diagram: Diagram) -> set[str]:
    """Signals between sensors and commands, outside signals among them.

    ModelError: the computer would use a signal that no sensor measures
    """
    made = {s: p for p in diagram.parts for s in p.outputs}
    sensors, electronic = sensor_signals(diagram), _electronic_signals(diagram)
    todo = _command_signals(diagram)
    computed: set[str] = set()
    visited: set[str] = set()
    while todo:
        name = todo.pop()
        if name in visited or name in sensors:
            continue
        visited.add(name)
        part = made.get(name)
        if isinstance(part, Moving | Attached | Linked):
            raise ModelError(
                f'{diagram.name}: the computer uses "{name}" of {part.name}, which is not '
                f"measured; sensors give {', '.join(sorted(sensors))}"
            )
        inputs = () if part is None else part.inputs
        if name in electronic:
            inputs = tuple(s for s in inputs if s not in diagram.outside)
        else:
            computed.add(name)
        todo += inputs
    return computed


def held_signals(
    diagram: Diagram, computed: Collection[str], sampled_inputs: Collection[str]
) -> list[str]:
    """Those of the computer's signals that something analog takes: the computer holds them.

    computed: what its parts make;  sampled_inputs: outside signals that it reads
    """
    commands = _command_signals(diagram)
    takers = {s for s in commands if s in computed or s in sampled_inputs}
    for part in diagram.parts:
        electronic = isinstance(part, Control) and part.analog
        if electronic or (isinstance(part, Junction) and part.output not in computed):
            takers |= {s for s in part.inputs if s in computed}
    return sorted(takers)


def _command_signals(diagram: Diagram) -> list[str]:
    plants = (c for c in diagram.controls if c.is_code and c.output in sensor_signals(diagram))
    commands = [part.command for part in diagram.blocks if isinstance(part, Moving)]
    return [*commands, *(s for c in plants for s in (c.input, *c.others))]


def _electronic_signals(diagram: Diagram) -> set[str]:
    """Outputs of analog controllers and of the junctions before and behind them.

    What a sensor reads of them the computer has from the sensor.
    """
    made = {j.output: j for j in diagram.junctions}
    sensors = sensor_signals(diagram)
    electronic = {c.output for c in diagram.controls if c.analog} - sensors
    electronic |= {c.input for c in diagram.controls if c.analog and c.input in made}
    grown = True
    while grown:
        behind = {j.output for j in made.values() if electronic & set(j.terms)}
        grown, electronic = not behind <= electronic, electronic | behind
    return electronic

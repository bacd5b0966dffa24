"""The computer in a diagram: the parts between sensors and commands."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import sympy as sp

from ..base.errors import ModelError
from ..diagrams import Attached, Control, Diagram, Junction, Kinematics, Linked, Moving
from ._linear import solve_linear
from .signal_symbols import (
    NO_VELOCITY,
    PERIOD,
    LateSignals,
    SignalReader,
    estimate,
    place_controller,
    rate_of,
    reading_symbol,
    signal,
    sum_inputs,
    travel_rate,
)


@dataclass(frozen=True)
class ComputerEquations:
    """The sampled part: states before and after their step over one sample, and the signals.

    rates: state -> continuous rate, with inputs held over a sample
    steps: state -> value at the next sample, for states that have no rate
    before: states that are stepped ahead of the output
    late: symbol -> (expression, delay) of signals that are kept for later samples
    """

    rates: Mapping[sp.Symbol, sp.Expr]
    steps: Mapping[sp.Symbol, sp.Expr]
    before: frozenset[sp.Symbol]
    signals: Mapping[str, sp.Expr]
    late: Mapping[sp.Symbol, tuple[sp.Expr, sp.Expr]] = field(default_factory=dict)


def sensor_signals(diagram: Diagram) -> set[str]:
    """Signals that the computer reads from a sensor.

    Outside signals, and what the computer itself makes, need none.
    """
    return set(diagram.measured) - set(diagram.outside) - _made_signals(diagram)


def _made_signals(diagram: Diagram) -> set[str]:
    """Outputs of the computer's controllers, and sums of nothing but these and outside signals."""
    made = {c.output for c in diagram.controls if not c.analog and not _is_plant(c, diagram)}
    known = made | set(diagram.outside)
    sums = [j for j in diagram.junctions if j.terms]
    while more := {j.output for j in sums if made & set(j.terms) and known >= set(j.terms)} - made:
        made |= more
        known |= more
    return made


def _is_plant(block: Control, diagram: Diagram) -> bool:
    """Whether the block is a plant that is code: a sensor measures its output."""
    return block.is_code and block.output in set(diagram.measured) - set(diagram.outside)


def computer_signals(diagram: Diagram) -> set[str]:
    """Signals between sensors and commands, with outside signals among them.

    raises ModelError: the computer would use a signal that no sensor measures
    """
    made = {s: p for p in diagram.parts for s in p.outputs}
    sensors, electronic = sensor_signals(diagram), _electronic_signals(diagram)
    commanded = _made_signals(diagram) | electronic
    todo = _command_signals(diagram)
    computed: set[str] = set()
    visited: set[str] = set()
    while todo:
        name = todo.pop()
        if name in visited:
            continue
        visited.add(name)
        part = made.get(name)
        if name in sensors:  # a sum may still hold commands, though a sensor reads it
            todo += [s for s in getattr(part, "terms", ()) if s in commanded]
            continue
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
    """Signals of the computer that analog parts use: the computer holds them over a sample.

    computed: outputs of its parts;  sampled_inputs: outside signals that it reads
    """
    commands = _command_signals(diagram)
    takers = {s for s in commands if s in computed or s in sampled_inputs}
    for part in diagram.parts:
        electronic = isinstance(part, Control) and part.analog
        if electronic or (isinstance(part, Junction) and part.output not in computed):
            takers |= {s for s in part.inputs if s in computed}
    return sorted(takers)


def _command_signals(diagram: Diagram) -> list[str]:
    plants = (c for c in diagram.controls if _is_plant(c, diagram))
    commands = [part.command for part in diagram.moving]
    return [*commands, *(s for c in plants for s in (c.input, *c.others))]


def _electronic_signals(diagram: Diagram) -> set[str]:
    """Outputs of analog controllers, and of the junctions before and behind them.

    Signals that a sensor reads are not included: the computer reads these from the sensor.
    """
    made = {j.output: j for j in diagram.junctions}
    sensors = sensor_signals(diagram)
    electronic = {c.output for c in diagram.controls if c.analog} - sensors
    electronic |= {c.input for c in diagram.controls if c.analog and c.input in made}
    grown = True
    while grown:  # a junction with an electronic signal is electronic as well
        behind = {j.output for j in made.values() if electronic & set(j.terms)}
        grown, electronic = not behind <= electronic, electronic | behind
    return electronic


@dataclass
class ComputerRows:
    """Equations of the computer's parts before they are solved.

    rows: expressions in its signals, each = 0;  outputs: names of these signals
    rates, steps: state -> rate, or value at the next sample
    before: states that are stepped ahead of the output
    """

    rows: list[sp.Expr] = field(default_factory=list)
    rates: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)
    steps: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)
    before: set[sp.Symbol] = field(default_factory=set)
    outputs: list[str] = field(default_factory=list)


def write_computer(
    diagram: Diagram,
    digital: Collection[str],
    of: SignalReader,
    rate: SignalReader,
    speed: SignalReader,
    period: sp.Expr = sp.S.Zero,
    *,
    late: LateSignals,
) -> ComputerRows:
    """Equations of the computer's parts; their delayed signals are put into `late`.

    digital: signals that the computer makes;  period: s, 0 in continuous time
    of, rate, speed: name of a signal -> symbol of its value, of its change over a sample, and of
        its velocity as the computer estimates it
    """
    result = ComputerRows()
    for part in diagram.parts:
        if isinstance(part, Control):
            if part.analog:
                continue
            travel = known = NO_VELOCITY
            if part.motion:
                moved = diagram.position(part.motion)
                readings = {x: of(x.name) for x in moved.free_symbols}
                travel, known = (rate_of(moved, f).xreplace(readings) for f in (rate, speed))
            others = tuple(map(of, part.others))
            equation = place_controller(
                part, of(part.input), travel, known, period, others=others, late=late
            )
            result.rows.append(signal(part.output) - equation.output)
            result.rates |= equation.rates
            result.steps |= equation.steps
            result.before |= equation.before
        elif isinstance(part, Junction | Kinematics) and part.output in digital:
            result.rows.append(signal(part.output) - sum_inputs(part, of))
        else:
            continue
        result.outputs += part.outputs
    return result


def solve_computer(diagram: Diagram, digital: Collection[str]) -> ComputerEquations:
    """Solved equations of a sampled computer;  digital: signals that it makes."""
    sensors = sensor_signals(diagram)

    def of(name: str) -> sp.Symbol:
        return reading_symbol(name) if name in sensors else signal(name)

    late: LateSignals = {}
    parts = write_computer(diagram, digital, of, travel_rate, estimate, PERIOD, late=late)
    solved, _ = solve_linear(parts.rows, [signal(s) for s in parts.outputs], diagram.name)
    return ComputerEquations(
        {x: r.xreplace(solved) for x, r in parts.rates.items()},
        {x: r.xreplace(solved) for x, r in parts.steps.items()},
        frozenset(parts.before),
        {s.name: e for s, e in solved.items()},
        {s: (e.xreplace(solved), d) for s, (e, d) in late.items()},
    )

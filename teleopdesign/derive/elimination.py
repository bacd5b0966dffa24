"""Symbolic transfer functions and impedances from the wiring; blocks need not commute.

Every block acts from the left on its signal. Signals are eliminated one by one in a fixed order. An
inverse appears only where a signal is on both sides of its equation.

Loops of a diagram, as the names of their signals.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from time import monotonic

import sympy as sp

from ..base.errors import ModelError
from ..controllers import exact_decimal
from ..diagrams import Attached, Control, Diagram, Kinematics, Linked, Moving, Part, position_symbol
from ..diagrams.wiring import acts_along_another
from .noncommutative import counterexample
from .printing import block_symbol, delay_symbol, motion_controller_symbol

#: an equation: signal -> coefficient (multiplied from the left); the sum of all products is zero
_Row = dict[str, sp.Expr]
_OUTPUT = "output asked for"


def rows(diagram: Diagram) -> list[_Row]:
    """One equation (sum = 0) for each block and junction.

    raises ModelError: a block has the name that the derivation uses for a part of another block
    """
    _check_names(diagram)
    equations: list[_Row] = []
    for part in diagram.parts:
        if isinstance(part, Moving):
            command = -block_symbol(f"A_{part.name}") if has_actuation(part) else sp.S(-1)
            terms = [(part.motion, block_symbol(part.name)), (part.command, command)]
            terms += [(s, sp.S(-sign)) for s, sign in part.loads.items()]
        elif isinstance(part, Attached):
            terms = [(part.force, sp.S(1)), (part.motion, -part.sign * block_symbol(part.name))]
        elif isinstance(part, Linked):
            equations += _rows_of_link(part)
            continue
        elif isinstance(part, Control):
            terms = [(part.output, sp.S(1)), *((s, -law) for s, law in paths(diagram, part))]
        elif isinstance(part, Kinematics):
            slopes = {s: sp.diff(part.expression, position_symbol(s)) for s in part.inputs}
            terms = [(part.output, sp.S(1)), *((s, -diagram.here(g)) for s, g in slopes.items())]
        else:
            weights = ((s, -diagram.here(g)) for s, g in part.terms.items())
            terms = [(part.output, sp.S(1)), *weights]
        equations.append(_row(terms))
    return equations


def _check_names(diagram: Diagram) -> None:
    """Refuse a block whose name is also the symbol of an actuator or of an entry of a link."""
    for part in diagram.blocks:
        if isinstance(part, Moving) and has_actuation(part):
            meanings = {f"A_{part.name}": f"the actuator of {part.name}"}
        elif isinstance(part, Linked):
            entries = (part.entry_name(i, j) for i, j in part.entries)
            meanings = dict.fromkeys(entries, f"an entry of {part.name}")
        else:
            continue
        for name, what in meanings.items():
            if diagram.has(name):
                raise ModelError(
                    f"{diagram.name}: {name} is {what}, and the name of a block: call the block "
                    "otherwise"
                )


def paths(diagram: Diagram, part: Control) -> list[tuple[str, sp.Expr]]:
    """Signals that drive a controller, each with its block: the input, and a motion if it uses one.

    raises ModelError: a block has the name of the controller's symbol for that motion
    """
    law = block_symbol(part.name) if part.dead_time is None else delay_symbol(part.name)
    if not acts_along_another(diagram, part):
        return [(part.input, law)]
    along = motion_controller_symbol(part.name)
    if diagram.has(along.name):
        raise ModelError(
            f"{diagram.name}: {along.name} is what {part.name} makes of the velocity of "
            f"{part.motion}, and the name of a block: call the block otherwise"
        )
    return [(part.input, law), (part.motion, along)]


def _rows_of_link(part: Linked) -> list[_Row]:
    equations: list[_Row] = [{force: sp.S(1)} for force in part.forces]
    for i, j in part.entries:
        equations[i][part.motions[j]] = -part.sign * block_symbol(part.entry_name(i, j))
    return equations


def _row(terms: list[tuple[str, sp.Expr]]) -> _Row:
    """Terms summed by signal: a part may use the signal that it produces."""
    row: _Row = {}
    for signal, coefficient in terms:
        row[signal] = row.get(signal, sp.S(0)) + _as_written(coefficient)
    return {signal: c for signal, c in row.items() if c != 0}


def _as_written(weight: sp.Expr) -> sp.Expr:
    """The weight with decimal numbers as fractions, because sums of floats are seldom exactly 0."""
    return weight.xreplace({x: exact_decimal(x) for x in weight.atoms(sp.Float)})


def has_actuation(part: Moving) -> bool:
    """Whether the body has actuation effects, so that the acting force is not the command."""
    return any(e.role == "actuation" for e in getattr(part.body, "effects", ()))


def transfer(
    diagram: Diagram,
    output: str,
    inputs: tuple[str, ...] | None = None,
    *,
    given: str | tuple[str, ...] = (),
    seconds: float = math.inf,
) -> dict[str, sp.Expr]:
    """Coefficients in `output` = sum of coefficient * input.

    inputs: signals from outside (default: all); all others are zero
    given: prescribed motions, in place of the outside forces that drive them
    seconds: after which the elimination stops
    returns: input -> coefficient
    raises ModelError: unknown signal, a loop without a solution, or more seconds than allowed
    """
    until = monotonic() + seconds
    diagram.signal(output)
    free = dict.fromkeys(diagram.outside)
    prescribed = given if isinstance(given, tuple) else (given,) if given else ()
    for motion in prescribed:
        free[motion] = None
        free.pop(_driver(diagram, motion), None)
    for name in inputs or ():
        diagram.signal(name)
        if name not in free:
            raise ModelError(f'{diagram.name}: signal "{name}" is not from outside')
    chosen = tuple(free) if inputs is None else inputs
    # a separate name for the output, so that what is inverted is an impedance, as in the papers
    system = [*rows(diagram), {_OUTPUT: sp.S(1), output: sp.S(-1)}]
    unknown = [s for s in diagram.signals if s not in free]
    for signal in _order(unknown, output, diagram):
        if monotonic() > until:
            raise ModelError(f'{diagram.name}: "{output}" was not derived within {seconds:g} s')
        _eliminate(system, signal, diagram)
    row = next(r for r in system if _OUTPUT in r)
    return {s: product(sp.S(-1), row.get(s, sp.S(0))) for s in chosen}


def round_trip(diagram: Diagram, part: Control) -> sp.Expr:
    """Loop gain at the output of a controller: the response there to 1 at the opened loop."""
    opened, out = diagram.open_at(part.name), part.output
    ways = paths(diagram, part)
    return sp.Add(*(product(law, transfer(opened, s, (out,))[out]) for s, law in ways))


def _driver(diagram: Diagram, motion: str) -> str:
    for block in diagram.moving:
        if block.motion == motion:
            return block.driver
    raise ModelError(f'{diagram.name}: "{motion}" is no motion of a body that forces move')


def _order(unknown: list[str], output: str, diagram: Diagram) -> list[str]:
    """Order of elimination: forces first, then the output, motions last."""
    motions = [b.motion for b in diagram.moving]
    forces = [s for s in unknown if s not in motions]
    forces.sort(key=lambda s: s == output)
    return [*forces, *(m for m in motions if m in unknown)]


def _eliminate(system: list[_Row], signal: str, diagram: Diagram) -> None:
    having = [r for r in system if signal in r]
    able = [r for r in having if _OUTPUT not in r and not _vanishes(r[signal])]
    if not able:
        raise ModelError(_explain_undetermined(diagram, signal))
    plain = [r for r in able if r[signal] in (sp.S(1), sp.S(-1))]
    defining = [r for r in plain if next(iter(r)) == signal]  # the equation that makes the signal
    pivot = (defining or plain or able)[0]
    system[:] = [r for r in system if r is not pivot]
    sign = sp.S(-1 if _mostly_negative(pivot[signal]) else 1)
    inverse = sp.Pow(product(sign, pivot[signal]), -1)
    value = {s: product(inverse, product(-sign, c)) for s, c in pivot.items() if s != signal}
    for row in (r for r in having if r is not pivot):
        factor = row.pop(signal)
        for s, c in value.items():
            total = row.get(s, sp.S(0)) + product(factor, c)
            if total == 0:
                row.pop(s, None)
            else:
                row[s] = total


def _vanishes(coefficient: sp.Expr) -> bool:
    """Whether a sum is zero; with inverses in it, decided on exact random rational matrices."""
    if not coefficient.is_Add:
        return False
    if any(p.exp < 0 for p in coefficient.atoms(sp.Pow)):
        return counterexample(coefficient, sp.S(0), tries=1) is None
    return bool(sp.expand(coefficient) == 0)


def _explain_undetermined(diagram: Diagram, signal: str) -> str:
    loop = loop_of(diagram, signal)
    if not loop:
        return f'{diagram.name}: the wiring does not determine "{signal}"'
    return f"{diagram.name}: the loop {' -> '.join((*loop, loop[0]))} has no solution"


def _mostly_negative(expression: sp.Expr) -> bool:
    terms = sp.Add.make_args(expression)
    return 2 * sum(bool(t.as_coeff_Mul()[0] < 0) for t in terms) > len(terms)


def product(left: sp.Expr, right: sp.Expr) -> sp.Expr:
    """The product; a plain number is multiplied into a sum."""
    # a plain number is carried into a sum, so that like terms meet
    if right.is_Add and left.is_Number:
        return sp.Add(*(left * a for a in right.args))
    if left.is_Add and right.is_Number:
        return sp.Add(*(a * right for a in left.args))
    return left * right


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

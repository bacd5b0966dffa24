"""Families of linear diagrams: a linear diagram with some of its values as symbols."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from ...blocks import Body
from ...controllers import Controller, exact_decimal, make_exact, parameter_symbol
from ...derive.all_states import all_states
from ...diagrams import Control, Diagram
from ...realise.lti import LinearBlocks, S, linear_blocks
from ...realise.simulated import without_absent
from ...realise.tips import with_tips
from ..ports import impedance_matrix, ports
from .box import ValueBox

#: points inside the box at which the family is compared with the diagram; each costs about 0.1 s
_COMPARED = 2


@dataclass(frozen=True)
class Family:
    """A linear diagram with some of its values as symbols.

    diagram: with each body that has a structure separated into two bodies
    symbols: name of a value -> its symbol;  linear: forms of all blocks in S and the symbols
    """

    diagram: Diagram
    symbols: Mapping[str, sp.Symbol]
    linear: LinearBlocks

    @property
    def is_rational(self) -> bool:
        """Whether no block has a dead time."""
        linear = self.linear
        forms = (*linear.blocks.values(), *linear.along.values(), *linear.actuation.values())
        return not self.linear.dead_times and not any(sp.sympify(f).has(sp.exp) for f in forms)

    def impedance(self) -> sp.Matrix:
        """Impedance matrix at the ports, forces over velocities, in S and the symbols."""
        return impedance_matrix(self.diagram, ports(self.diagram), linear=self.linear)

    def characteristic(self) -> sp.Expr:
        """Determinant of all equations, in S and the symbols: its zeros are all poles."""
        whole = all_states(self.diagram, values=self.symbols).determinant()
        return (whole / max(map(abs, whole.values()), default=1)).as_expr()


def family_of(diagram: Diagram, box: ValueBox) -> Family | None:
    """The diagram with the values of the box as symbols.

    returns: None where there is no such form: a value is not in the linear form of its block (in a
        body's structure, in a system of numbers), the form changes within the box, or a law takes
        the velocity of another motion than its input
    raises ModelError: a block without values
    """
    whole = _separate_structures(diagram)
    linear = linear_blocks(whole)
    symbols = {n: sp.Dummy(f"v{k}", real=True) for k, n in enumerate(box.names)}
    blocks, actuation = dict(linear.blocks), dict(linear.actuation)
    for name in {n.partition(".")[0] for n in box.names}:
        if not whole.has(name):
            return None
        of_block = {n.partition(".")[2]: s for n, s in symbols.items() if n.startswith(f"{name}.")}
        forms = _forms(whole, name, of_block)
        if forms is None:
            return None
        blocks[name] = forms[0]
        if name in actuation:
            actuation[name] = forms[1]
    made = Family(whole, symbols, replace(linear, blocks=blocks, actuation=actuation))
    return made if _agrees(made, diagram, box) else None


def _forms(
    diagram: Diagram, name: str, symbols: Mapping[str, sp.Symbol]
) -> tuple[sp.Expr, sp.Expr] | None:
    """Forms of a block and of its actuation, with these parameters as symbols; None: none exist."""
    part = diagram.block(name)
    if isinstance(part, Control):
        law = part.controller
        if not isinstance(law, Controller) or part.dead_time is not None:
            return None
        form = law.linear_form(part.name, S, sp.S(0))
        if form is None:
            return None
        numbers = {parameter_symbol(part.name, n): (n, v) for n, v in law.names().items()}
        forms, parameters = (form, sp.S(1)), law.names()
    elif isinstance(getattr(part, "body", None), Body):
        body = part.body
        assert isinstance(body, Body)
        parameters = {n: v.value for n, v in body.parameters.items()}
        numbers = {s: (n, parameters[n]) for n, s in body.symbols().items()}
        forms = (body.impedance(S)[0], body.actuation(S)[0])
    else:
        return None
    if not set(symbols) <= set(parameters):
        return None
    placed = {x: symbols.get(n, exact_decimal(v)) for x, (n, v) in numbers.items()}
    first, second = (make_exact(sp.sympify(f).subs(placed)) for f in forms)
    return first, second


def _separate_structures(diagram: Diagram) -> Diagram:
    """The diagram without absent effects, and with each structure as a separate body."""
    for part in diagram.bodies:
        if isinstance(part.body, Body):
            diagram = diagram.with_block(part.name, without_absent(part.body))
    return with_tips(diagram)


def _agrees(family: Family, diagram: Diagram, box: ValueBox) -> bool:
    """Whether the blocks of a family are exactly those of the diagram at some points of the box.

    The points are two inside the box and two opposite vertices, because values may make an effect
    absent at an end of an interval.
    """
    varied = {n.partition(".")[0] for n in box.names}
    # a body that is parted at its structure is several blocks: all are compared then
    parted = any(family.diagram.has(f"{name}_tip") for name in varied)
    blocks_compared = ("",) if parted else tuple(varied)
    for point in (np.array(box.low), np.array(box.high), *box.inside(_COMPARED, 0)):
        values = box.named(point)
        there = _separate_structures(diagram.with_values(values))
        placed = {family.symbols[n]: exact_decimal(v) for n, v in values.items()}
        for one in blocks_compared:
            exact = linear_blocks(there, only=one)
            for here, forms in (
                (family.linear.blocks, exact.blocks),
                (family.linear.actuation, exact.actuation),
            ):
                if not (one or here.keys() == forms.keys()) or not forms.keys() <= here.keys():
                    return False
                pairs = ((sp.sympify(here[n]).subs(placed), form) for n, form in forms.items())
                if any(a != b and sp.cancel(sp.together(a - b)) != 0 for a, b in pairs):
                    return False
    return True

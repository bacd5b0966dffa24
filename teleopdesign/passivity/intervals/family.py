"""Families of linear diagrams: a linear diagram with some of its values as symbols."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix

from ...blocks import Body
from ...controllers import Controller, Stage, exact_decimal, make_exact, parameter_symbol
from ...derive import symbol_values
from ...derive.elimination import rows
from ...diagrams import Control, Diagram
from ...realise.lti import LinearBlocks, S, linear_blocks
from ...realise.simulated import without_absent
from ...realise.tips import with_tips
from ..linear.hidden_modes import cancelled_poles
from ..linear.in_full import effect_modes, stage_rows
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
        """Determinant of all equations, times the denominators of the blocks, in S and the symbols.

        Its zeros are all poles. Poles that no port shows are included, and poles that a zero of the
        same block cancels, also in blocks whose values are symbols.
        """
        free = set(self.diagram.outside)
        unknown = [s for s in self.diagram.signals if s not in free]
        values = symbol_values(self.linear)
        equations = []
        for row in rows(self.diagram):
            placed = {s: make_exact(sp.sympify(c).subs(values)) for s, c in row.items()}
            terms = {s: sp.cancel(c) for s, c in placed.items()}
            below = sp.lcm_list([sp.fraction(c)[1] for c in terms.values()])
            equations.append([sp.cancel(terms.get(s, sp.S(0)) * below) for s in unknown])
        matrix = DomainMatrix.from_Matrix(sp.Matrix(equations)).to_field()
        whole = matrix.domain.to_sympy(matrix.det())
        varied = {n.partition(".")[0] for n in self.symbols}
        for part in self.diagram.controls:
            if part.name in varied:
                whole *= self._cancelled_within(part)
            elif part.dead_time is None:
                whole *= cancelled_poles(part, self.linear).as_expr()
        return whole * self._cancelled_by_effects()

    def _cancelled_by_effects(self) -> sp.Expr:
        """Modes of effects that the form of their body does not show: a polynomial in S."""
        hidden = sp.S(1)
        for part in self.diagram.bodies:
            if not isinstance(part.body, Body):
                continue
            values = {n: exact_decimal(v.value) for n, v in part.body.parameters.items()}
            placed = {
                s: self.symbols.get(f"{part.name}.{n}", values[n])
                for n, s in part.body.symbols().items()
            }
            modes = effect_modes(part.body, placed)
            forms = self.linear.blocks, self.linear.actuation
            for whole, shown in zip(modes, forms, strict=True):
                below = sp.fraction(sp.cancel(shown.get(part.name, sp.S(1))))[1]
                hidden *= sp.cancel(whole / below)
        return hidden

    def _cancelled_within(self, part: Control) -> sp.Expr:
        """Poles of a controller's stages that the form of the whole controller lacks."""
        assert isinstance(part.controller, Controller)
        symbols = {n.partition(".")[2]: s for n, s in self.symbols.items()
                   if n.startswith(f"{part.name}.")}  # fmt: skip
        product = sp.S(1)
        for stage in part.controller.stages:
            product *= _stage_denominator(stage, symbols)
        below = sp.fraction(sp.cancel(self.linear.blocks[part.name]))[1]
        return sp.cancel(product / below)


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


def _stage_denominator(stage: Stage, symbols: Mapping[str, sp.Symbol]) -> sp.Expr:
    """Denominator of one stage without cancellation, with some of its parameters as symbols."""

    def placed(name: str, value: float) -> sp.Expr:
        return symbols.get(f"{stage.name}.{name}", exact_decimal(value))

    if "denominator_0" in stage.values:
        return sp.Add(
            *(
                placed(name, value) * S ** int(name.rpartition("_")[2])
                for name, value in stage.values.items()
                if name.startswith("denominator_")
            )
        )
    known = {f"{stage.name}.{n}": placed(n, v) for n, v in stage.values.items()}
    rates, _ = stage_rows(stage, known)
    n = len(rates)
    return (S * sp.eye(n) - sp.Matrix(n, n, lambda i, j: rates[i][j])).det(method="berkowitz")


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

"""Linear form of each block of a diagram, for one degree of freedom.

Bodies give the impedance that their effects declare; controllers their law at a frozen speed. What
has no linear form is left out, and named.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from ..blocks import Body
from ..controllers import Controller, parameter_symbol
from ..diagrams import Control, Diagram, Linked, Moving
from ..errors import ModelError

if TYPE_CHECKING:
    import control

S = sp.Symbol("s")


@dataclass(frozen=True)
class LinearBlocks:
    """Transfer function of each block at `s`: of bodies the impedance relative to position (N/m).

    actuation: name of a body -> transfer function from its command to its acting force
    left_out: "block.effect" or "block" for what has no linear form;  speed: frozen, m/s or rad/s
    """

    blocks: Mapping[str, sp.Expr]
    actuation: Mapping[str, sp.Expr]
    left_out: tuple[str, ...]
    speed: float


def linear_blocks(diagram: Diagram, *, speed: float = 0.0) -> LinearBlocks:
    """Linear forms of all blocks with their values in place.

    speed: at which smoothed friction and schedules are frozen
    raises ModelError: a block is known by its name only
    """
    blocks: dict[str, sp.Expr] = {}
    actuation: dict[str, sp.Expr] = {}
    left_out: list[str] = []
    for part in diagram.blocks:
        if isinstance(part, Control):
            if not isinstance(part.controller, Controller):
                raise ModelError(
                    f"{diagram.name}: {part.name} is known by its name only, no values"
                )
            form = part.controller.linear_form(part.name, S, sp.Float(abs(speed)))
            values = part.controller.names().items()
            numbers = {parameter_symbol(part.name, n): v for n, v in values}
            blocks[part.name] = sp.S(0) if form is None else form.subs(numbers)
            left_out += [part.name] if form is None else []
            continue
        if isinstance(part, Linked):
            blocks |= {part.entry_name(i, j): part.body.entry(i, j, S) for i, j in part.entries}
            continue
        if not isinstance(part.body, Body):
            raise ModelError(f"{diagram.name}: {part.name} is known by its name only, no values")
        impedance, gone = part.body.impedance(S)
        blocks[part.name] = impedance.subs(part.body.numbers())
        left_out += [f"{part.name}.{name}" for name in gone]
        if isinstance(part, Moving):
            stage, gone = part.body.actuation(S)
            actuation[part.name] = stage.subs(part.body.numbers())
            left_out += [f"{part.name}.{name}" for name in gone]
    return LinearBlocks(blocks, actuation, tuple(left_out), abs(speed))


def as_transfer_function(expression: sp.Expr, *, delay_order: int = 4) -> control.TransferFunction:
    """A rational expression in `S`, dead times by Pade of that order, as python-control system."""
    import control

    def rational(power: sp.Expr) -> sp.Expr:
        tau = float(-sp.diff(power, S))
        above, below = control.pade(tau, delay_order)
        return sp.Poly(above, S).as_expr() / sp.Poly(below, S).as_expr()

    expression = sp.sympify(expression, strict=True).replace(sp.exp, rational)
    above, below = sp.fraction(sp.cancel(sp.together(sp.nsimplify(expression, rational=True))))
    coefficients = [[float(c) for c in sp.Poly(p, S).all_coeffs()] for p in (above, below)]
    lead = coefficients[1][0]
    return control.tf(*[[c / lead for c in p] for p in coefficients])

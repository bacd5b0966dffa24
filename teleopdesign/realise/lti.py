"""Linear form of each block of a diagram, for one degree of freedom.

Bodies have the impedance that their effects declare; controllers have their law at a frozen speed.
An effect or block without a linear form is left out, and named. Numbers are exact, as they were
written: terms that cancel on paper cancel here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import Controller, exact_decimal, make_exact, parameter_symbol, require_kept
from ..diagrams import Control, Diagram, Linked, Moving
from ..diagrams.wiring import acts_along_another, without_motion

if TYPE_CHECKING:
    import control

S = sp.Symbol("s")


@dataclass(frozen=True)
class LinearBlocks:
    """Transfer function of each block at `s`: of bodies the impedance relative to position (N/m).

    actuation: name of a body -> transfer function from its command to its acting force
    left_out: "block.effect" or "block" without a linear form;  speed: frozen, m/s or rad/s
    held: names of discrete-time controllers, which are included with their held samples
    dead_times: of delay blocks, s
    along: for controllers that use the velocity of a motion other than their input: transfer
        function from that motion; `blocks` has the one from their input
    """

    blocks: Mapping[str, sp.Expr]
    actuation: Mapping[str, sp.Expr]
    left_out: tuple[str, ...]
    speed: float
    held: tuple[str, ...] = ()
    dead_times: Mapping[str, sp.Expr] = field(default_factory=dict)
    along: Mapping[str, sp.Expr] = field(default_factory=dict)


def linear_blocks(
    diagram: Diagram, *, speed: float = 0.0, held: bool = False, only: str = ""
) -> LinearBlocks:
    """Linear forms of all blocks, with exact numbers for their values.

    only: name of one block; blank: all blocks
    speed: at which smoothed friction and schedules are frozen
    held: whether discrete-time controllers are included, as H(e^(s T)) (1 - e^(-s T))/(s T). This
        is a frequency response below half the sampling rate, and no basis for a proof
    raises ModelError: a block is known by its name only, a plant as code only, or a law uses a
        velocity without a motion, or declares what its equations do not keep
    """
    along: dict[str, sp.Expr] = {}
    blocks: dict[str, sp.Expr] = {}
    actuation: dict[str, sp.Expr] = {}
    left_out: list[str] = []
    sampled: list[str] = []
    require_kept(s for c in diagram.controls for s in c.stages)
    times = {
        c.name: exact_decimal(c.dead_time) for c in diagram.controls if c.dead_time is not None
    }
    for part in diagram.blocks if not only else (diagram.block(only),):
        if isinstance(part, Control):
            if part.is_code and part.analog and part.output in diagram.measured:
                raise ModelError(
                    f"{diagram.name}: {part.name} is a plant known as code only, and without it "
                    "nothing is left to derive: simulate, or give it linear (`control.linearize`)"
                )
            forms = _forms_of_controller(diagram, part, speed, held)
            blocks[part.name] = forms[0] if forms else sp.S(0)
            if len(forms) == 2:
                along[part.name] = forms[1]
            if not forms:
                left_out.append(part.name)
            elif any(stage.law.in_z is not None for stage in part.stages):
                sampled.append(part.name)
            continue
        if isinstance(part, Linked):
            blocks |= {
                part.entry_name(i, j): make_exact(part.body.entry(i, j, S)) for i, j in part.entries
            }
            continue
        if not isinstance(part.body, Body):
            raise ModelError(f"{diagram.name}: {part.name} is known by its name only, no values")
        for name, value in part.body.parameters.items():
            if math.isinf(value.value):
                where = f"{diagram.name}: {part.name}.{name}"
                raise ModelError(f"{where} is infinite: leave its effect out of a linear form")
        impedance, gone = part.body.impedance(S)
        blocks[part.name] = _insert_numbers(impedance, part.body.numbers())
        left_out += [f"{part.name}.{name}" for name in gone]
        if isinstance(part, Moving):
            stage, gone = part.body.actuation(S)
            actuation[part.name] = _insert_numbers(stage, part.body.numbers())
            left_out += [f"{part.name}.{name}" for name in gone]
    gone, names = tuple(left_out), tuple(sampled)
    return LinearBlocks(blocks, actuation, gone, abs(speed), names, times, along)


def _forms_of_controller(
    diagram: Diagram, part: Control, speed: float, held: bool
) -> tuple[sp.Expr, ...]:
    """Transfer functions of a controller from its input, and from another motion; (): none."""
    if not isinstance(part.controller, Controller):
        raise ModelError(f"{diagram.name}: {part.name} is known by its name only, no values")
    at = part.name, S, exact_decimal(abs(speed))
    forms = part.controller.linear_parts(*at, held=held)
    if forms is None:
        return ()
    if part.controller.sees_velocity and not part.motion:
        raise without_motion(f"{diagram.name}: {part.name}")
    numbers = {parameter_symbol(part.name, n): v for n, v in part.controller.names().items()}
    if acts_along_another(diagram, part):
        return tuple(_insert_numbers(form, numbers) for form in forms)
    whole = part.controller.linear_form(*at, held=held)
    return (_insert_numbers(whole, numbers),)


def _insert_numbers(form: sp.Expr, numbers: Mapping[sp.Symbol, float]) -> sp.Expr:
    """The form with exact values of its symbols, as they were written."""
    exact = {symbol: exact_decimal(value) for symbol, value in numbers.items()}
    return make_exact(sp.sympify(form).subs(exact))


def as_transfer_function(expression: sp.Expr, *, delay_order: int = 4) -> control.TransferFunction:
    """A rational expression in `S` as a python-control system, with dead times by Pade.

    delay_order: of the Pade approximation
    raises ModelError: the expression holds a measured frequency response
    """
    from ..base import python_control as control

    def rational(power: sp.Expr) -> sp.Expr:
        tau = float(-sp.diff(power, S))
        above, below = ([exact_decimal(c) for c in side] for side in control.pade(tau, delay_order))
        return sp.Poly(above, S).as_expr() / sp.Poly(below, S).as_expr()

    if expression.atoms(AppliedUndef):
        raise ModelError("a measured frequency response is no rational function: fit one to it")
    exact = make_exact(expression).replace(sp.exp, lambda power: rational(power))
    above, below = (sp.Poly(p, S) for p in sp.fraction(sp.cancel(sp.together(exact))))
    lead = below.LC()
    return control.tf(*[[float(c / lead) for c in p.all_coeffs()] for p in (above, below)])


def numerical(expression: sp.Expr) -> Callable[[np.ndarray], np.ndarray]:
    """The expression in `S` as a function of complex s, (n,); exact numbers become floats."""
    inexact = {x: sp.Float(x) for x in expression.atoms(sp.Rational) if not x.is_Integer}
    # an integer may be longer than what numpy takes
    inexact |= {x: sp.Float(x) for x in expression.atoms(sp.Integer) if abs(x) >= 2**31}
    # the module: by its name sympy would import all that belongs to it, f2py and tests included
    call = sp.lambdify(S, expression.xreplace(inexact), [np])

    def values(s: np.ndarray) -> np.ndarray:
        s = np.asarray(s, dtype=complex)
        return np.broadcast_to(np.asarray(call(s), dtype=complex), s.shape)

    return values

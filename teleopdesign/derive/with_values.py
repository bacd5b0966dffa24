"""A derived transfer function with the linear form of every block inserted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from ..base.errors import ModelError
from ..diagrams import Diagram
from ..realise.lti import LinearBlocks, as_transfer_function, linear_blocks
from ..realise.parted import linear_parted
from .elimination import transfer
from .printing import block_symbol, dead_time_symbol, motion_controller_symbol

if TYPE_CHECKING:
    import control


def with_values(
    diagram: Diagram,
    *,
    output: str,
    input: str,
    given: str | tuple[str, ...] = "",
    speed: float = 0.0,
    held: bool = False,
) -> tuple[sp.Expr, LinearBlocks]:
    """Transfer function in `realise.lti.S` with numbers, and the linear forms of its blocks.

    For one degree of freedom. Raises ModelError where a loop has no solution at its values.

    given: prescribed motions
    speed: m/s or rad/s, at which smoothed friction and schedules are frozen
    held: whether controllers in discrete time take part, see `linear_blocks`
    """
    motions = given if isinstance(given, tuple) else (given,) if given else ()
    diagram, tips = linear_parted(diagram, motions)
    output, input = tips.get(output, output), tips.get(input, input)
    linear = linear_blocks(diagram, speed=speed, held=held)
    form = transfer(diagram, output, (input,), given=tuple(tips.values()))[input]
    expression = sp.sympify(form).subs(symbol_values(linear))
    if expression.has(sp.zoo, sp.nan, sp.oo):
        raise ModelError(f"{output}/{input}: a loop has no solution at these values")
    return expression, linear


def symbol_values(linear: LinearBlocks) -> dict[sp.Symbol, sp.Expr]:
    """Symbol of a derived expression -> transfer function of the block, stage or dead time.

    Substituted into a result of `derive`, these leave a function of s; dead times are in s.
    """
    values = {block_symbol(n): e for n, e in linear.blocks.items()}
    values |= {block_symbol(f"A_{n}"): e for n, e in linear.actuation.items()}
    values |= {motion_controller_symbol(n): e for n, e in linear.along.items()}
    return values | {dead_time_symbol(n): t for n, t in linear.dead_times.items()}


def transfer_function(
    diagram: Diagram,
    *,
    output: str = "R_M",
    input: str = "R_D",
    given: str | tuple[str, ...] = "",
    speed: float = 0.0,
    delay_order: int = 4,
) -> tuple[control.TransferFunction, tuple[str, ...]]:
    """The transfer function as a python-control system, and the names without linear form.

    Its input and output have the names of the signals, so that `control.interconnect` can connect
    it. Other arguments are those of `with_values`.

    delay_order: of the Pade approximation of dead times
    """
    expression, linear = with_values(diagram, output=output, input=input, given=given, speed=speed)
    system = as_transfer_function(expression, delay_order=delay_order)
    system.update_names(inputs=[input], outputs=[output])
    return system, linear.left_out

"""The named transfer functions and impedances of a haptic interface.

With values, each block has its linear form.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from ..base.errors import ModelError
from ..base.frozen import ByName, Frozen
from ..diagrams import Control, Diagram
from ..realise.lti import LinearBlocks, as_transfer_function, linear_blocks
from ..realise.simulated import linear_parted
from ..realise.tips import linear_tips
from .elimination import round_trip, transfer
from .printing import (
    as_latex,
    as_text,
    block_symbol,
    dead_time_symbol,
    motion_controller_symbol,
    with_gamma,
)

if TYPE_CHECKING:
    import control


@dataclass(frozen=True)
class TransferFunctions(ByName):
    """Symbolic transfer functions by name; `Gamma` stands for I + H where the diagram has H."""

    diagram: Diagram
    expressions: Mapping[str, sp.Expr]
    texts: Mapping[str, str]

    def _names(self) -> Mapping[str, sp.Expr]:
        return self.expressions

    def __getitem__(self, name: str) -> sp.Expr:
        if name not in self.expressions:
            has = ", ".join(self.expressions)
            raise ModelError(f'transfer functions: no "{name}", have {has}')
        return self.expressions[name]

    def text(self) -> str:
        """One line for each function: name = expression (meaning)."""
        return "\n".join(f"{n} = {as_text(e)}    ({self.texts[n]})" for n, e in self._short())

    def latex(self) -> str:
        """The body of an align environment, one line for each function."""
        return " \\\\\n".join(f"{_LATEX.get(n, n)} &= {as_latex(e)}" for n, e in self._short())

    def _short(self) -> list[tuple[str, sp.Expr]]:
        return [(n, with_gamma(e)) for n, e in self.expressions.items()]

    def __repr__(self) -> str:
        return self.text()

    def _repr_latex_(self) -> str:
        return f"$$\\begin{{aligned}}{self.latex()}\\end{{aligned}}$$"


_LATEX = {
    "T_o": "T_o",
    "T_MBC": r"T_{\mathrm{MBC}}",
    "T_FF": r"T_{\mathrm{FF}}",
    "T_H": "T_H",
    "Zhat_M": r"\hat Z_M",
    "L/L_D": "L/L_D",
    "L/R_V": "L/R_V",
}


def transfer_functions(diagram: Diagram) -> TransferFunctions:
    """The named transfer functions of a haptic interface: T_o, T_MBC, T_FF, T_H, Zhat_M, L.

    T_o, T_MBC, T_FF and T_H are from R_D to R_M at R_V = 0: uncompensated, with C, with H, with
    both. Zhat_M = (R_D - R_M)/L. L is the response of a position loop K. Only functions for which
    the diagram has the blocks are derived; other blocks are left out of the diagram for them.
    Bernstein, Lawrence, Pao, World Haptics 2005, eqs (2) to (5) and (7), figure 4.
    raises ModelError: the diagram lacks a signal of a haptic interface

        >>> parts = {"hand": td.ANY, "cancellation": td.ANY, "force_feedback": td.ANY}
        >>> td.transfer_functions(td.haptic_interface(**parts))
        T_o = Z_H (Z_H + Z_M)^-1    (R_D to R_M, uncompensated)
        T_MBC = Z_H (Z_H + Z_M - C)^-1    (R_D to R_M, motion-based cancellation)
        T_FF = Z_H (Z_M + Gamma Z_H)^-1 Gamma    (R_D to R_M, force feedback)
        T_H = Z_H (Z_M + Gamma Z_H - C)^-1 Gamma    (R_D to R_M, hybrid)
        Zhat_M = Gamma^-1 (Z_M - C)    (L to R_D - R_M: apparent mechanism impedance)
    """
    if lacks := [s for s in ("L", "R_D", "R_M", "E") if s not in diagram.signals]:
        raise ModelError(
            f"{diagram.name}: no signal {lacks[0]}, expected a haptic interface: "
            "`derive_transfers` derives those of any diagram"
        )
    cases = named_cases(diagram)
    expressions = {name: case.derive() for name, case in cases.items()}
    texts = {name: case.text for name, case in cases.items()}
    return TransferFunctions(diagram, Frozen(expressions), Frozen(texts))


@dataclass(frozen=True)
class Case:
    """Input, output and prescribed motions of one transfer function; other inputs are zero.

    given: prescribed motions, as in `transfer`;  text: meaning in words
    """

    diagram: Diagram
    output: str
    input: str
    given: str | tuple[str, ...]
    text: str

    def derive(self, *, seconds: float = math.inf) -> sp.Expr:
        """The expression in the blocks; arguments and errors are those of `transfer`.

        A device with a linear transmission is two bodies, as in `with_values`, and a prescribed
        motion is that of its tip.
        """
        motions = self.given if isinstance(self.given, tuple) else (self.given,)
        apart, tips = linear_parted(self.diagram, tuple(m for m in motions if m))
        output, input = (tips.get(s, s) for s in (self.output, self.input))
        given = tuple(tips.values())
        return transfer(apart, output, (input,), given=given, seconds=seconds)[input]


def named_cases(diagram: Diagram) -> dict[str, Case]:
    """The cases of the named transfer functions of a haptic interface, see `transfer_functions`."""
    force = diagram.open_at("K")
    by_name: dict[str, Case] = {}
    if diagram.has("Z_H"):
        cases = {"T_o": ("C", "H"), "T_MBC": ("H",), "T_FF": ("C",), "T_H": ()}
        for name, gone in cases.items():
            if all(diagram.has(b) for b in {"C", "H"} - set(gone)):
                by_name[name] = Case(force.without(*gone), "R_M", "R_D", "", _TEXTS[name])
    by_name["Zhat_M"] = Case(force, "E", "L", "L", _TEXTS["Zhat_M"])
    if diagram.has("K"):
        for signal in ("L_D", "R_V"):
            by_name[f"L/{signal}"] = Case(diagram, "L", signal, "", "position loop closed")
    return by_name


_TEXTS = {
    "T_o": "R_D to R_M, uncompensated",
    "T_MBC": "R_D to R_M, motion-based cancellation",
    "T_FF": "R_D to R_M, force feedback",
    "T_H": "R_D to R_M, hybrid",
    "Zhat_M": "L to R_D - R_M: apparent mechanism impedance",
}


def return_difference(diagram: Diagram, name: str) -> sp.Expr:
    """Return difference 1 - loop gain at the output of controller `name`.

    Closed-loop poles are its zeros; every other loop stays closed. Blocks keep their order.

    raises ModelError: `name` is no controller
    """
    diagram = linear_tips(diagram)
    block = diagram.block(name)
    if not isinstance(block, Control):
        raise ModelError(f"{diagram.name}: {name} is no controller, its loop cannot be opened")
    return sp.S(1) - round_trip(diagram, block)


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

"""Every transfer function and impedance of a diagram, for any wiring."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

from ..base.errors import ModelError, did_you_mean
from ..base.frozen import ByName, Frozen
from ..diagrams import AnyBlock, Attached, Control, Diagram
from ..diagrams.short_form import kind_of
from ..realise.tips import linear_tips
from .printing import as_latex, as_text, block_symbol, name_as_latex, with_gamma
from .transfer_functions import Case, named_cases, transfer_function
from .two_port import has_two_sides, two_port_cases

if TYPE_CHECKING:
    import control

SECONDS = 2.0  # longest time for the derivation of one output


@dataclass(frozen=True)
class Transfer:
    """One transfer function: output = expression * input, with all other inputs zero."""

    name: str
    case: Case
    expression: sp.Expr

    def text(self) -> str:
        """The equation name = expression, as plain text."""
        return f"{self.name} = {as_text(with_gamma(self.expression))}"

    def __repr__(self) -> str:
        return self.text()

    def latex(self) -> str:
        """One line of an align environment."""
        return f"{name_as_latex(self.name)} &= {as_latex(with_gamma(self.expression))}"

    def system(self, *, speed: float = 0.0) -> tuple[control.TransferFunction, tuple[str, ...]]:
        """Transfer function with values, for one degree of freedom, and blocks without linear form.

        speed: m/s or rad/s, at which smoothed friction and schedules are frozen
        raises ModelError: a block has no values, or a loop no solution at its values
        """
        case = self.case
        try:
            return transfer_function(
                case.diagram, output=case.output, input=case.input, given=case.given, speed=speed
            )
        except (ZeroDivisionError, TypeError, sp.PolynomialError) as error:
            # what sympy makes of 1/0 is no number and no polynomial
            raise ModelError(f"{self.name}: a loop has no solution at these values") from error


@dataclass(frozen=True)
class Transfers(ByName):
    """The transfer functions of a diagram.

    transfers: name -> transfer function;  undone: name -> reason why it was not derived
    """

    diagram: Diagram
    transfers: Mapping[str, Transfer]
    undone: Mapping[str, str]

    def _names(self) -> Mapping[str, Transfer]:
        return self.transfers

    def __getitem__(self, name: str) -> Transfer:
        if name not in self.transfers:
            raise ModelError(f'transfer functions: no "{name}"{did_you_mean(name, self.transfers)}')
        return self.transfers[name]

    @property
    def has_values(self) -> bool:
        """Whether every block has values, so that each transfer function is a system, too."""
        contents = [b.controller if isinstance(b, Control) else b.body for b in self.diagram.blocks]
        return not any(isinstance(c, AnyBlock) for c in contents)

    def text(self) -> str:
        """One line for each transfer function, with its meaning."""
        lines = [f"{t.text()}    ({t.case.text})" for t in self.transfers.values()]
        if self._uses_gamma():
            lines.append("Gamma = I + H")
        return "\n".join([*lines, *(f"{n}: {why}" for n, why in self.undone.items())])

    def latex(self) -> str:
        """Body of an align environment."""
        lines = [t.latex() for t in self.transfers.values()]
        if self._uses_gamma():
            lines.append(r"\Gamma &= I + H")
        return " \\\\\n".join(lines)

    def as_data(self, *, speed: float = 0.0) -> dict[str, Any]:
        """Plain data for JSON; coefficients in SI from the highest power of s."""
        return {
            "diagram": self.diagram.name,
            "speed": abs(speed),
            "transfers": [self._one(t, speed) for t in self.transfers.values()],
            "not_derived": dict(self.undone),
        }

    def _one(self, one: Transfer, speed: float) -> dict[str, Any]:
        case = one.case
        data: dict[str, Any] = {
            "name": one.name,
            "output": case.output,
            "input": case.input,
            "given": case.given,
            "meaning": case.text,
            "blocks": [b.name for b in case.diagram.blocks],
            "text": as_text(with_gamma(one.expression)),
            "latex": as_latex(with_gamma(one.expression)),
        }
        if self.has_values:
            try:
                system, left_out = one.system(speed=speed)
            except ModelError as error:
                return {**data, "no_system": str(error)}
            data["numerator"] = [float(c) for c in system.num[0][0]]
            data["denominator"] = [float(c) for c in system.den[0][0]]
            data["left_out"] = list(left_out)
        return data

    def _uses_gamma(self) -> bool:
        gamma = block_symbol("Gamma")
        return any(gamma in with_gamma(t.expression).free_symbols for t in self.transfers.values())

    def __repr__(self) -> str:
        return self.text()

    def _repr_latex_(self) -> str:
        return f"$$\\begin{{aligned}}{self.latex()}\\end{{aligned}}$$"


def all_transfers(diagram: Diagram, *, seconds: float = SECONDS) -> Transfers:
    """Every transfer function of a diagram, and the impedance at the driver of each moving body.

    From each outside signal to each measured signal and to each force of an attached body. For a
    haptic interface or a teleoperator, the named functions come first (`transfer_functions`,
    `two_port_functions`). A device with a linear transmission is two bodies, and the motion of its
    tip is measured. Blocks need not commute. Functions that take longer than `seconds`, or have no
    solution, are listed in `undone`.

        >>> td.derive_transfers(td.haptic_interface(cancellation=td.ANY))
        Zhat_M = Z_M - C    (L to R_D - R_M: apparent mechanism impedance)
        L/R_V = (Z_M - C)^-1    (R_V to L)
        L/R_D = (Z_M - C)^-1    (R_D to L)
        R_M/R_V = -1    (R_V to R_M)
        R_M/R_D = 0    (R_D to R_M)
        R_V/L = Z_M - C    (impedance at R_V, with all other inputs zero)
    """
    transfers: dict[str, Transfer] = {}
    undone: dict[str, str] = {}
    named: Mapping[str, Case] = {}
    if kind_of(diagram) == "haptic interface":
        named = named_cases(diagram)
    elif has_two_sides(diagram):
        named = two_port_cases(diagram)
    for name, case in named.items():
        _derive(name, case, transfers, undone, seconds)
    diagram = linear_tips(diagram)
    outputs = [*diagram.measured]
    outputs += [b.force for b in diagram.blocks if isinstance(b, Attached)]
    for output in dict.fromkeys(outputs):
        for signal, case in _from_outside(diagram, output).items():
            if f"{output}/{signal}" not in transfers:
                _derive(f"{output}/{signal}", case, transfers, undone, seconds)
    for block in diagram.moving:
        if block.driver in diagram.outside:
            text = f"impedance at {block.driver}, with all other inputs zero"
            case = Case(diagram, block.driver, block.motion, block.motion, text)
            _derive(f"{block.driver}/{block.motion}", case, transfers, undone, seconds)
    return Transfers(diagram, Frozen(transfers), Frozen(undone))


def _from_outside(diagram: Diagram, output: str) -> dict[str, Case]:
    return {
        s: Case(diagram, output, s, "", f"{s} to {output}") for s in diagram.outside if s != output
    }


def _derive(
    name: str, case: Case, transfers: dict[str, Transfer], undone: dict[str, str], seconds: float
) -> None:
    try:
        transfers[name] = Transfer(name, case, case.derive(seconds=seconds))
    except ModelError as error:
        undone[name] = str(error)

"""Sums of signals, and positions that depend on others; weights may depend on positions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError, check_name, quote
from ..base.frozen import Frozen

#: a sign, a factor, or an expression of positions (on `position_symbol`), such as a lever arm
Weight: TypeAlias = float | sp.Expr


def position_symbol(name: str) -> sp.Symbol:
    """Symbol of a position (m or rad), for weights of forces and for kinematics."""
    return sp.Symbol(name, real=True)


def as_expression(weight: Weight, *, where: str) -> sp.Expr:
    """A weight as sympy expression; a text is refused, because `read_expression` reads texts.

    raises ModelError: neither a number nor an expression
    """
    try:
        expression = sp.sympify(weight, strict=True)
    except sp.SympifyError:
        expression = None
    if not isinstance(expression, sp.Expr):
        shown = quote(weight) if isinstance(weight, str) else type(weight).__name__
        raise ModelError(f"{where}: found {shown}, expected a number or a sympy expression")
    return expression


def check_names(where: str, *names: str) -> None:
    """Refuse names that no signal may have;  where: beginning of a message."""
    for name in names:
        check_name(name, where=where)


@check_types
@dataclass(frozen=True)
class Junction:
    """A summing junction: output = sum of weight * signal.

    A weight may depend on positions: torque = lever arm(angle) * force.
    """

    output: str
    terms: Mapping[str, Weight]

    def __post_init__(self) -> None:
        check_name(self.output, where="junction")
        check_names(self.name, *self.terms)
        for signal, weight in self.terms.items():
            as_expression(weight, where=f"{self.name}: {signal}")
        check_names(self.name, *self.arms)
        object.__setattr__(self, "terms", Frozen(self.terms))

    @property
    def name(self) -> str:
        return f"junction {self.output}"

    @property
    def outputs(self) -> tuple[str, ...]:
        return (self.output,)

    @property
    def arms(self) -> tuple[str, ...]:
        """Positions on which the weights depend."""
        return tuple(sorted({x for w in self.terms.values() for x in _symbol_names(w)}))

    @property
    def inputs(self) -> tuple[str, ...]:
        return (*self.terms, *(x for x in self.arms if x not in self.terms))


@check_types
@dataclass(frozen=True)
class Kinematics:
    """A position that depends on others: output = expression of positions (`position_symbol`).

    axis: of the output, "prismatic" or "revolute"
    """

    output: str
    expression: sp.Expr
    axis: str = "prismatic"

    def __post_init__(self) -> None:
        check_name(self.output, where="kinematics")
        as_expression(self.expression, where=self.name)
        check_names(self.name, *self.inputs)

    @property
    def name(self) -> str:
        return f"kinematics {self.output}"

    @property
    def outputs(self) -> tuple[str, ...]:
        return (self.output,)

    @property
    def inputs(self) -> tuple[str, ...]:
        return _symbol_names(self.expression)


def _symbol_names(expression: Weight) -> tuple[str, ...]:
    return tuple(sorted(s.name for s in sp.sympify(expression, strict=True).free_symbols))

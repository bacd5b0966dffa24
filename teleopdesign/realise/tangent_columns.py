"""The parameters and probes by which signals along a motion have tangents."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp


@dataclass(frozen=True, eq=False)
class Probe:
    """A direction in which a model may change: the strength of an effect, at zero.

    at: place;  symbol: of the strength;  values: symbol -> value of the effect's other parameters
    """

    at: str
    symbol: sp.Symbol
    values: Mapping[sp.Symbol, float]


@dataclass(frozen=True)
class LinkParameter:
    """A base parameter of an arm; at: body of the joint;  index: number of the parameter."""

    at: str
    index: int


class TangentColumns(tuple[sp.Symbol | Probe | LinkParameter, ...]):
    """The p columns of tangents (p, n), with the place of each.

    A dictionary holds the places: on short records a search among symbols, which compares one
    after the other, takes longer than the arithmetic.
    """

    @cached_property
    def places(self) -> dict[sp.Symbol | Probe | LinkParameter, int]:
        """Column -> its place."""
        return {column: j for j, column in enumerate(self)}

    @cached_property
    def symbols(self) -> tuple[sp.Symbol | LinkParameter, ...]:
        """The symbol of each column; of a probe that of its strength."""
        return tuple(getattr(column, "symbol", column) for column in self)

    @cached_property
    def of_symbols(self) -> dict[sp.Symbol | LinkParameter, int]:
        """Symbol of a column -> the first place that has it."""
        return {s: j for j, s in reversed(list(enumerate(self.symbols)))}

    def __contains__(self, column: Any) -> bool:
        return column in self.places

    def index(self, column: Any, *_: Any) -> int:
        """Place of the column; raises KeyError: not among the columns."""
        return self.places[column]

"""A point of a study as measures receive it, and the value of a measure with unit and text."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, get_type_hints

import numpy as np

from ..base.arguments import conforming
from ..base.errors import ModelError
from ..base.expectations import describe_value
from ..base.frozen import ByValue
from ..simulate import Simulation
from .case import SimulatedCase


@dataclass(frozen=True)
class Amount:
    """The value of a measure: a number, a text, or numbers over one dimension.

    unit: SI; "": not known at this point, taken from another point
    text: meaning in words;  over: (dimension, its values, its unit) of an array (n,)
    """

    value: Any
    unit: str = "1"
    text: str = ""
    over: tuple[str, tuple[float, ...], str] | None = None


@dataclass(frozen=True, eq=False)
class SignalRows:
    """Samples of a signal, (rows,), over time, s, with its unit."""

    time: np.ndarray
    values: np.ndarray
    unit: str


@dataclass(frozen=True, eq=False)
class Point:
    """One point of a study as measures receive it.

    content: result of the model: a `SimulatedCase`, or anything that its function returned
    values: parameter -> value;  seed: of this point, the same on every machine
    simulated: returns the simulation if it was computed together with other points;  rows: returns
        one signal of it, without a labelled array for each point, which would take 0.3 ms
    """

    content: Any
    values: Mapping[str, Any]
    seed: tuple[int, ...] = (0, 0)
    simulated: Callable[[], Simulation] | None = None
    rows: Callable[[str], SignalRows] | None = None

    @property
    def case(self) -> SimulatedCase:
        """The case; raises ModelError: the model returned something else."""
        if not isinstance(self.content, SimulatedCase):
            raise ModelError(
                f"the model returned {describe_value(self.content)}, expected a diagram"
            )
        return self.content

    @cached_property
    def simulation(self) -> Simulation:
        """The simulation, computed once for all measures."""
        if self.simulated is not None:
            return self.simulated()
        return self.content if isinstance(self.content, Simulation) else self.case.simulate()

    def signal(self, name: str) -> SignalRows:
        """A signal of the simulation."""
        if self.rows is not None:
            return self.rows(name)
        data = self.simulation[name]
        return SignalRows(data["time"].values, data.values, str(data.attrs["units"]))

    @property
    def result(self) -> Any:
        """The argument for a user's measure."""
        if not isinstance(self.content, SimulatedCase):
            return self.content
        return self.simulation if self.content.duration else self.content.diagram

    def rng(self) -> np.random.Generator:
        """Random generator of this point."""
        return np.random.default_rng(self.seed)


PointFunction = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Kind(ByValue):
    """A measure of the package: a function of a point and options -> Amount, or several by name.

    signals: all that it needs of a simulation: signals, or options that name signals
    """

    function: PointFunction
    signals: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        return self.function.__name__.removeprefix("_")

    @property
    def options(self) -> dict[str, Any]:
        """Option -> default; `...` if required."""
        declared = inspect.signature(self.function).parameters.values()
        named = (p for p in declared if p.kind is p.KEYWORD_ONLY)
        return {p.name: ... if p.default is p.empty else p.default for p in named}

    def check(self, option: str, value: Any) -> None:
        """Raise ModelError for a value that is none of the option's type."""
        kind = get_type_hints(self.function)[option]
        conforming(value, kind, f"measure {self.name}: {option}")

    @property
    def text(self) -> str:
        return (self.function.__doc__ or "").strip().split("\n")[0]

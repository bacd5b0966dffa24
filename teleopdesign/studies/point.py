"""A point of a study as measures receive it, and the value of a measure with unit and text."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, get_type_hints

import numpy as np

from ..base.arguments import conforming
from ..base.errors import GrowsWithoutBound, ModelError
from ..base.expectations import describe_value
from ..base.frozen import ByValue
from ..diagrams import Diagram
from ..simulate import Simulation
from .case import SimulatedCase

if TYPE_CHECKING:
    import xarray


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
class SideBySide:
    """Signals of points that were simulated side by side, as arrays.

    A labelled array for each point would take 0.3 ms.

    rows: signal -> (points, rows);  reasons: why a point has no signals, or ""
    """

    time: np.ndarray
    rows: Mapping[str, np.ndarray]
    attributes: Mapping[str, Mapping[str, Any]]
    reasons: tuple[str, ...]

    @classmethod
    def of(cls, signals: xarray.Dataset) -> SideBySide:
        """The block of signals over `case` and `time`."""
        named = {str(name): signals[name] for name in signals.data_vars}
        return cls(
            signals["time"].values,
            {name: one.values for name, one in named.items()},
            {name: one.attrs for name, one in named.items()},
            tuple(map(str, signals["reason"].values)),
        )

    def signal(self, point: int, name: str) -> SignalRows:
        """A signal of a point; raises the error with which the simulation of the point ended."""
        if reason := self.reasons[point]:
            words = GrowsWithoutBound.words
            raise GrowsWithoutBound(reason) if words in reason else ModelError(reason)
        unit = str(self.attributes[name]["units"])
        return SignalRows(self.time, self.rows[name][point], unit)

    def simulation(self, point: int, diagram: Diagram) -> Simulation:
        """All signals of a point; raises the error with which its simulation ended."""
        import xarray

        data: dict[str, Any] = {
            name: ("time", self.signal(point, name).values, self.attributes[name])
            for name in self.rows
        }
        time = ("time", self.time, {"units": "s"})
        return Simulation(diagram, xarray.Dataset(data, {"time": time}))


@dataclass(frozen=True, eq=False)
class Point:
    """One point of a study as measures receive it.

    content: result of the model: a `SimulatedCase`, or anything that its function returned
    values: parameter -> value;  seed: of this point, the same on every machine
    beside: signals of points that were simulated together, and the row of this one
    """

    content: Any
    values: Mapping[str, Any]
    seed: tuple[int, ...] = (0, 0)
    beside: tuple[SideBySide, int] | None = None

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
        if self.beside is not None:
            block, row = self.beside
            return block.simulation(row, self.case.diagram)
        return self.content if isinstance(self.content, Simulation) else self.case.simulate()

    def signal(self, name: str) -> SignalRows:
        """A signal of the simulation."""
        if self.beside is not None:
            block, row = self.beside
            return block.signal(row, name)
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

"""Measures of a study: those of the package by name, or any function of a result.

    "tracking_error"                              one of the package
    measure("rms", signal="R_M")                  with its options
    lambda simulation: float(abs(simulation["E"]).max())

A function takes the result of the point: the simulation where there is a duration, else the diagram
or the value that the model's function returned. The function returns a number, a text, a mapping of
names to numbers or texts, or a labelled array.

What is wrong with every point of a study is refused before its first point.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..base.errors import ModelError, UnknownSignal, unknown
from ..base.expectations import describe_value, number_check
from ..base.frozen import ByValue
from ..simulate import Setup
from .case import SimulatedCase
from .measures import MEASURES
from .point import Amount, Point, PointFunction
from .points import Points, check_name


@dataclass(frozen=True, eq=False)
class Measure(ByValue):
    """A measure of a study, with its options.

    name: of its values in the result
    function: takes a `Point` (measures of the package), or the result of the point
    of_package: whether the measure is one of the package
    signals: all signals of a simulation that it needs; empty: unknown, it may need any
    """

    name: str
    function: PointFunction = field(repr=False)
    options: Mapping[str, Any] = field(default_factory=dict)
    of_package: bool = False
    signals: tuple[str, ...] = ()

    def __call__(self, point: Point) -> dict[str, Amount]:
        """The values of a point, by name."""
        value = self.function(point if self.of_package else point.result, **self.options)
        if isinstance(value, Mapping):
            return {str(k): _amount(v, f"{self.name}: {k}") for k, v in value.items()}
        return {self.name: _amount(value, self.name)}


def measure(name: str, **options: Any) -> Measure:
    """A measure of the package with options: measure("rms", signal="R_M").

    raises ModelError: no measure of that name, an option that it does not have or that is missing

        >>> td.measure("rms", signal="R_M").name
        'rms_R_M'
    """
    kind = MEASURES[name]
    for option in options:
        if option not in kind.options:
            raise ModelError(f"measure {name}: {unknown('option', option, kind.options)}")
    for option, default in kind.options.items():
        if default is ... and option not in options:
            raise ModelError(f'measure {name}: option "{option}" has no value')
    for option, content in options.items():
        kind.check(option, content)
    values = {**{k: v for k, v in kind.options.items() if v is not ...}, **options}
    signal = values.get("signal") if kind.options.get("signal", "") is ... else None
    label = f"{name}_{signal}" if signal else name
    signals = tuple(str(values.get(s, s)) for s in kind.signals)
    return Measure(label, kind.function, values, of_package=True, signals=signals)


def require_one_meaning(measures: Iterable[Measure]) -> None:
    """Refuse two measures with one name: the values of one would stand for those of the other.

    raises ModelError: with the name
    """
    known: dict[str, Measure] = {}
    for one in measures:
        other = known.setdefault(one.name, one)
        if (other.function, dict(other.options)) != (one.function, dict(one.options)):
            raise ModelError(
                f'two different measures are called "{one.name}": make one of them a function with '
                "a name of its own"
            )


def measures_of(content: Any) -> tuple[Measure, ...]:
    """One measure or several; a mapping gives their names.

    raises ModelError: a name twice, something that is no measure, none at all
    """
    if isinstance(content, Mapping):
        listed = [_measure_of(m, str(name)) for name, m in content.items()]
    elif isinstance(content, str | Measure) or callable(content):
        listed = [_measure_of(content)]
    elif isinstance(content, list | tuple | set | frozenset):
        listed = [_measure_of(m) for m in content]
    else:
        listed = [_measure_of(content)]  # refuses it
    names = [m.name for m in listed]
    if doubled := {n for n in names if names.count(n) > 1}:
        raise ModelError(
            f'measures: "{min(doubled)}" is there twice: name them, {{"name": measure}}'
        )
    for name in names:
        check_name(name, "measures: measure")
    if not listed:
        raise ModelError(f"measures: found none, expected a function or {', '.join(MEASURES)}")
    return tuple(listed)


def _measure_of(content: Any, name: str = "") -> Measure:
    if isinstance(content, str):
        content = measure(content)
    if isinstance(content, Measure):
        return replace(content, name=name) if name else content
    if not callable(content):
        raise ModelError(
            f"found {describe_value(content)}, expected a measure: a function, or a name of "
            f"{', '.join(MEASURES)}"
        )
    label = getattr(content, "__name__", type(content).__name__)
    return Measure(name or ("measure" if label == "<lambda>" else label), content)


def _amount(value: Any, where: str) -> Amount:
    """A value that a user's measure returned, as an `Amount`."""
    if isinstance(value, Amount):
        return value
    if hasattr(value, "dims") and hasattr(value, "attrs"):  # a labelled array
        unit, text = str(value.attrs.get("units", "1")), str(value.attrs.get("text", ""))
        if not value.dims:
            return replace(_amount(value.values[()], where), unit=unit, text=text)
        along = value[value.dims[0]]
        if len(value.dims) == 1 and {value.dtype.kind, along.dtype.kind} <= {*"biuf"}:
            (dimension,) = value.dims
            over = (
                str(dimension),
                tuple(float(x) for x in along.values),
                str(along.attrs.get("units", "1")),
            )
            return Amount([float(x) for x in value.values], unit, text, over)
        raise ModelError(
            f"measure {where}: found an array of {value.dtype} over "
            f"{', '.join(f'{d} ({value[d].dtype})' for d in value.dims)}, expected numbers over "
            "one dimension of numbers"
        )
    if isinstance(value, np.generic) or isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, np.ndarray | list | tuple):
        array = np.asarray(value)
        if array.ndim == 1 and array.dtype.kind in "biuf":
            over = (f"{where}_entry", tuple(float(i) for i in range(len(array))), "1")
            return Amount([float(x) for x in array], over=over)
    if isinstance(value, bool | int | float):
        return Amount(float(value))
    if isinstance(value, str):
        # what no file can hold is escaped
        written = value.encode("utf-8", "backslashreplace").decode().replace("\0", "\\x00")
        return Amount(written)
    if value is None:
        raise ModelError(
            f"measure {where}: returned nothing (None), expected a number (NaN: none) or a text"
        )
    raise ModelError(
        f"measure {where}: found {describe_value(value)}, "
        "expected a number, a text, a mapping of names "
        "to such, or a labelled array"
    )


def check_case(case: SimulatedCase, points: Points, measures: Iterable[Measure]) -> None:
    """Raise ModelError for texts as values, and for names of signals and states that are unknown.

    Numbers out of bounds are no matter of this check: such a point fails, and others do not.
    """
    for name, column in points.columns.items():
        if column.values.dtype.kind not in "biuf":
            _refuse(name, column.values[0])
    for name, value in points.fixed.items():
        if number_check(value) is not None:
            _refuse(name, value)
    setup = _setup(case, points)
    if setup is None:
        return
    layout = setup.program.layout
    for measure in measures:
        for signal in measure.signals:
            if signal not in layout.columns:
                raise ModelError(
                    f"measure {measure.name}: {unknown('signal', signal, layout.columns)}"
                )


def _refuse(name: str, value: object) -> None:
    raise ModelError(f"study: {name}: found {describe_value(value)}, expected a number (SI)")


def _setup(case: SimulatedCase, points: Points) -> Setup | None:
    """The simulation at the first point; None if there is none, for reasons of its values."""
    if not case.duration and "duration" not in points.names:
        return None
    try:
        return case.with_values(points.at(0)).setup()
    except UnknownSignal:
        raise
    except ModelError:
        return None

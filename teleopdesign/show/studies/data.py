"""Axes and measures of a study's data by their names, and texts of their labels."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.arguments import number as number_of
from ...base.errors import ModelError, did_you_mean, unknown
from ...base.expectations import describe_value
from ...base.sentences import unit_at_axis
from ..figures.style import symbol

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

    from ...studies.plots import StudyPlots

#: an axis is logarithmic if the ratios of neighbouring values differ by less than this (relative)
_EVEN = 1e-3


@dataclass(frozen=True, eq=False)
class StudyData:
    """The data of a study for its figures: the methods take names of axes and measures.

    raises ModelError: no such axis or measure
    """

    data: xarray.Dataset

    @property
    def axes(self) -> list[str]:
        """Names of the parameters, in the order of the study."""
        return list(json.loads(self.data.attrs["axes"]))

    def name(self, name: str) -> str:
        """The text for a parameter or a measure in a label."""
        return words(self.data[name].attrs.get("long_name") or name)

    def name_with_value(self, name: str, value: Any) -> str:
        """The text "parameter = value unit"."""
        unit = (
            "" if isinstance(value, str) else unit_at_axis(self.data[name].attrs.get("units", ""))
        )
        return f"{self.name(name)} = {number(value)} {unit}".rstrip()

    def is_number(self, *names: str) -> bool:
        """Whether the values of all these variables are numbers and not words."""
        return all(self.data[n].dtype.kind in "biuf" for n in names)

    def measure(self, name: str) -> xarray.DataArray:
        """The measure of that name, which must have numbers;  "": the first such measure."""
        listed = [str(n) for n in self.data.data_vars if n != "failure"]
        known = [n for n in listed if self.is_number(n)]
        if not name and known:
            name = known[0]
        if name in known:
            return self.data[name]
        if not listed:
            raise ModelError("study: every point failed: there is nothing to draw")
        if name in listed or not name:
            raise ModelError(f"study: {name or ', '.join(listed)}: found texts, expected numbers")
        raise ModelError(f"study: {unknown('measure in numbers', name, known)}")

    def at(self, values: xarray.DataArray, at: Mapping[str, float] | None) -> xarray.DataArray:
        """The values nearest to the point `at`, without axes that have only one value left."""
        for name, value in (at or {}).items():
            self.require(name, [str(d) for d in values.dims])
            if self.data[name].dtype.kind in "biuf":
                values = values.sel({name: number_of(value, f"at: {name}")}, method="nearest")
                continue
            texts = self.data[name].values.tolist()
            if value not in texts:
                raise ModelError(
                    f"study: at: {name}: found {describe_value(value)}, expected one of "
                    f"{', '.join(texts)}{did_you_mean(str(value), texts)}"
                )
            values = values.sel({name: value})
        return values.squeeze(drop=True)

    def require(self, name: str, known: Sequence[str]) -> None:
        """Raise ModelError if `name` is not a known axis."""
        if name not in known:
            raise ModelError(f"study: {unknown('axis', name, known)}")

    def pair(self, values: xarray.DataArray, x: str, y: str) -> tuple[str, str]:
        """The axes of a map, across and up: x and y if given, else the last two.

        raises ModelError: the values do not have two axes, or there is no such axis
        """
        dims = [str(d) for d in values.dims]
        if x and x == y:
            raise ModelError(f'study: a map over "{x}" alone: expected two axes, x and y')
        if len(dims) != 2:
            raise ModelError(
                f"study: a map has two axes, found {', '.join(dims) or 'none'}"
                f"{': give values of the others: at=...' if len(dims) > 2 else ''}"
            )
        for name in (x, y):
            if name:
                self.require(name, dims)
        across = x or next(d for d in reversed(dims) if d != y)
        up = y or next(d for d in dims if d != across)
        return across, up

    def label_axis(self, axis: Axes, which: str, name: str) -> None:
        """Label the axis "x" or "y" of a panel; logarithmic if the values have a constant ratio."""
        values = self.data[name].values
        if values.dtype.kind in "biuf" and len(values) > 2 and (values > 0).all():
            ratios = values[1:] / values[:-1]
            if np.ptp(ratios) < _EVEN * ratios[0] and ratios[0] > 1.01:
                axis.set(**{f"{which}scale": "log"})
        axis.set(**{f"{which}label": label(self.data[name])})


def data_of(plots: StudyPlots) -> StudyData:
    """The data of a study, with rising axes."""
    return StudyData(sort_axes(plots.data))


def sort_axes(data: Any) -> Any:
    """The data (Dataset or DataArray) with the values of each axis of numbers in rising order.

    Lines and cells of a figure join neighbours; the order of a study is that of its user.
    """
    for name in data.dims:
        if name in data.coords and data[name].dtype.kind in "biuf":
            data = data.sortby(name)
    return data


def label(array: xarray.DataArray) -> str:
    """Name and unit of an array, for an axis."""
    unit = array.attrs.get("units", "")
    name = words(array.attrs.get("long_name") or str(array.name))
    return f"{name} ({unit_at_axis(unit)})" if unit else name


def words(name: str) -> str:
    """The name with spaces, and a signal at its end as a symbol: "rms_R_FF" is rms and R_FF.

    A name with a dot is a path of the model and stays unchanged; so does text between dollar signs.
    """
    if "$" in name or "." in name:
        return "$".join(
            part if k % 2 or "." in part else part.replace("_", " ")
            for k, part in enumerate(name.split("$"))
        )
    parts = name.split("_")
    for k in range(len(parts) - 1):  # a letter without an index may be anybody's name
        signal = symbol("_".join(parts[k:]))
        if signal.startswith("$"):
            return " ".join([*parts[:k], signal])
    return " ".join(parts)


def number(value: Any) -> str:
    """The number with three significant digits; a word stays unchanged."""
    return value if isinstance(value, str) else f"{float(value):.3g}"


def spread(count: int, most: int) -> list[int]:
    """Indices, at most `most` and evenly spaced, out of range(count)."""
    return sorted({round(k) for k in np.linspace(0, count - 1, min(count, most))})

"""The points of a study: the product of grids and of jointly drawn points.

The axes of a study from its file: a value, a list or a grid for each parameter, or samples.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.errors import ExperimentError, ModelError, quote
from ..base.expectations import describe_value
from ..base.toml import Table, describe_toml_value
from .samples import (
    Samples,
    distribution_text,
    latin_hypercube,
    random_samples,
    sensitivity_samples,
    sobol,
)

#: name of the dimension of points that were drawn together
SAMPLE = "sample"
#: names of variables that every study has
_TAKEN = ("failure",)
#: most points of a study: each number of a point takes 8 bytes while the study runs and 8 in the
#: result; the reason of a failure and the list of open points take some tens of bytes
MOST_POINTS = 100_000_000

#: parameter -> values (a separate dimension), or one value;  or points drawn together
Axes = Mapping[str, Any] | Samples | Sequence[Mapping[str, Any] | Samples]


@dataclass(frozen=True)
class Column:
    """The values of a parameter along its dimension."""

    dimension: str
    values: np.ndarray


@dataclass(frozen=True)
class Points:
    """Every point of a study, numbered in row order (the last dimension varies fastest).

    sizes: dimension -> length;  columns: parameters that vary;  fixed: those that do not
    samples: jointly drawn points, None where there are none
    """

    sizes: Mapping[str, int]
    columns: Mapping[str, Column]
    fixed: Mapping[str, Any]
    samples: Samples | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(self.sizes.values())

    @property
    def names(self) -> tuple[str, ...]:
        return (*self.columns, *self.fixed)

    def __len__(self) -> int:
        return int(np.prod([*self.shape], dtype=object)) if self.sizes else 1

    def at(self, index: int) -> dict[str, Any]:
        """Parameter -> value at the point `index`."""
        where = dict(zip(self.sizes, np.unravel_index(index, self.shape), strict=True))
        varied = {n: _plain_number(c.values[where[c.dimension]]) for n, c in self.columns.items()}
        return {**varied, **self.fixed}

    def table(self, first: int, last: int) -> dict[str, np.ndarray]:
        """Parameter -> values at the points from `first` to below `last`, (last - first,)."""
        where = dict(
            zip(self.sizes, np.unravel_index(np.arange(first, last), self.shape), strict=True)
        )
        return {n: c.values[where[c.dimension]] for n, c in self.columns.items()}


def points_of(axes: Axes) -> Points:
    """The points that grids and samples span.

    raises ModelError: a parameter twice, an axis without a value, two samples, too many points
    """
    parts = list(axes) if isinstance(axes, list | tuple) else [axes]
    sizes: dict[str, int] = {}
    columns: dict[str, Column] = {}
    fixed: dict[str, Any] = {}
    samples = None
    for part in parts:
        if not isinstance(part, Mapping | Samples):
            raise ModelError(
                f"study: axes: found {describe_value(part)}, expected a mapping of parameters to "
                "values, or samples"
            )
        names = part.names if isinstance(part, Samples) else tuple(part)
        for name in names:
            if name in columns or name in fixed:
                raise ModelError(f'study: axes: parameter "{name}" is there twice')
            if not isinstance(name, str):
                raise ModelError(f"study: axes: found {describe_value(name)}, expected a parameter")
            check_name(name, "study: axes: parameter")
        if isinstance(part, Samples):
            if samples is not None:
                raise ModelError("study: axes: points drawn together are there twice")
            samples = part
            sizes[SAMPLE] = len(part)
            columns |= {n: Column(SAMPLE, part.values[:, i]) for i, n in enumerate(names)}
            continue
        for name, content in part.items():
            values = _values(name, content)
            if values is None:
                fixed[name] = _plain_number(content)
            else:
                sizes[name] = len(values)
                columns[name] = Column(name, values)
    if samples is not None and SAMPLE in columns:
        raise ModelError(
            f'study: axes: "{SAMPLE}" numbers the points drawn together: name it otherwise'
        )
    points = Points(sizes, columns, fixed, samples)
    if len(points) > MOST_POINTS:
        raise ModelError(f"study: {len(points):.3g} points, expected at most {MOST_POINTS:.0e}")
    return points


def check_name(name: str, where: str) -> None:
    """Raise ModelError for a name that no variable of a study's file can have."""
    if name in _TAKEN or "/" in name or not name.isprintable() or not name:
        raise ModelError(
            f"{where} {quote(name)}: expected another name: it stands for a variable of the data "
            f"set, not empty, without / and not {' or '.join(_TAKEN)}"
        )


def _values(name: str, content: Any) -> np.ndarray | None:
    """Values of an axis, (n,) of numbers or texts; None if there is only one value."""
    if hasattr(content, "ppf"):
        raise ModelError(
            f"study: {name}: found the distribution {distribution_text(content)}, expected values; "
            'draw points with latin_hypercube({"' + name + '": ...}, 100, seed=1)'
        )
    if isinstance(content, Mapping | Set):
        raise ModelError(
            f"study: {name}: found {describe_value(content)}, expected values in a list"
        )
    is_one = not hasattr(content, "__len__") or getattr(content, "shape", None) == ()
    if is_one or isinstance(content, str):
        if not isinstance(content, str | bool | int | float | np.number | np.bool_):
            raise ModelError(f"study: {name}: found {describe_value(content)}, expected values")
        if not isinstance(content, str) and np.isnan(content):
            raise ModelError(f"study: {name}: found the number nan, expected a value")
        return None
    listed = list(content) if not isinstance(content, np.ndarray) else content
    if len(listed) and all(isinstance(x, str) for x in listed):
        values = np.array(listed, dtype=object)
    else:
        try:
            values = np.asarray(listed)
        except ValueError:  # rows of different lengths
            values = np.empty((0, 0))
        if values.dtype.kind not in "biuf" or values.ndim != 1:
            raise ModelError(
                f"study: {name}: found {describe_value(content)}, "
                "expected numbers or texts in one row"
            )
        if values.dtype.kind == "f" and not np.isfinite(values).all():
            first = values[~np.isfinite(values)][0]
            raise ModelError(f"study: {name}: found values that are not finite ({first})")
    if not len(values):
        raise ModelError(f"study: {name}: found no value, expected at least one")
    listed = values.tolist()
    if len(set(listed)) < len(values):
        twice = next(v for k, v in enumerate(listed) if v in listed[:k])
        raise ModelError(f"study: {name}: a value is there twice ({twice!r})")
    return values


def _plain_number(value: Any) -> Any:
    """A number of numpy as a Python number; other values unchanged."""
    return value.item() if isinstance(value, np.generic) else value


#: most values of one axis
_MOST_VALUES = 1_000_000
_METHODS: Mapping[str, Callable[..., Samples]] = {
    "latin_hypercube": latin_hypercube,
    "sobol": sobol,
    "random": random_samples,
    "sensitivity": sensitivity_samples,
}
_SCALES = ("linear", "log")


def read_axes(root: Table) -> list[Any]:
    """Axes of a study: one mapping from the table [axes], then the samples of [samples]."""
    table = root.table("axes")
    parts: list[Any] = []
    if table.content:
        parts.append({name: _read_axis(table, name) for name in table.content})
    if "samples" in root.content:
        parts.append(_read_samples(root.table("samples")))
    return parts


def _read_axis(table: Table, name: str) -> Any:
    """Read a list, one value, or { from, to, points, scale }."""
    content = table.content[name]
    if isinstance(content, dict):
        grid = table.table(name)
        grid.allow(("from", "to", "points", "scale"))
        (low, high, is_log), count = _read_ends(grid), read_whole(grid, "points")
        if not 1 < count <= _MOST_VALUES or low == high:
            raise ExperimentError(
                f"{grid.where()}: found {count} points from {low:g} to {high:g}, expected at least "
                "2 between two numbers"
            )
        return (np.geomspace if is_log else np.linspace)(low, high, count)
    if isinstance(content, list):
        if not content or not (
            all(map(_is_number, content)) or all(isinstance(x, str) for x in content)
        ):
            raise ExperimentError(
                f"{table.where(name)}: found {describe_toml_value(content)}, "
                "expected numbers or texts, at least one"
            )
        return content if isinstance(content[0], str) else [float(x) for x in content]
    return content if isinstance(content, str) else table.number(name)


def _read_samples(table: Table) -> Samples:
    table.allow(("method", "points", "seed", "ranges"))
    method = table.choice("method", _METHODS)
    ranges = table.table("ranges")
    if not ranges.content:
        raise ExperimentError(f"{table.where('ranges')}: found none, expected at least one")
    seed = read_whole(table, "seed") if "seed" in table.content else 0
    extents = {name: _read_range(ranges.table(name)) for name in ranges.content}
    return _METHODS[method](extents, read_whole(table, "points"), seed=seed)


def _read_range(table: Table) -> Any:
    """Read { from, to }, with scale = "log" or step if wanted, or { mean, standard_deviation }."""
    from scipy.stats import loguniform, norm

    if "mean" in table.content:
        table.allow(("mean", "standard_deviation"))
        return norm(table.number("mean"), table.number("standard_deviation", above=0.0))
    table.allow(("from", "to", "scale", "step"))
    low, high, is_log = _read_ends(table)
    if low >= high:
        raise ExperimentError(f"{table.where()}: found {low:g} to {high:g}, expected from < to")
    if "step" in table.content:
        return low, high, table.number("step", above=0.0)
    return loguniform(low, high) if is_log else (low, high)


def _read_ends(table: Table) -> tuple[float, float, bool]:
    """The ends of a range, and whether its scale is logarithmic."""
    low, high = table.number("from"), table.number("to")
    is_log = table.choice("scale", _SCALES, default="linear") == "log"
    if is_log and min(low, high) <= 0:
        raise ExperimentError(f"{table.where()}: a log scale needs from and to above 0")
    return low, high, is_log


def read_whole(table: Table, key: str) -> int:
    """The whole number under a key, 0 or more; raises ExperimentError: another number."""
    number = table.number(key)
    if number != int(number) or number < 0:
        raise ExperimentError(f"{table.where(key)}: found {number:g}, expected a whole number")
    return int(number)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)

"""The axes of a study from its file: a value, a list or a grid for each parameter, or samples."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..base.errors import ExperimentError, did_you_mean, quote
from ..base.toml import Table, describe_toml_value
from .samples import (
    Samples,
    latin_hypercube,
    random_samples,
    sensitivity_samples,
    sobol,
)

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
        low, high, count = grid.number("from"), grid.number("to"), read_whole(grid, "points")
        if not 1 < count <= _MOST_VALUES or low == high:
            raise ExperimentError(
                f"{grid.where()}: found {count} points from {low:g} to {high:g}, expected at least "
                "2 between two numbers"
            )
        if _read_scale(grid) == "log":
            if min(low, high) <= 0:
                raise ExperimentError(f"{grid.where()}: a log scale needs from and to above 0")
            return np.geomspace(low, high, count)
        return np.linspace(low, high, count)
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
    method = table.text("method")
    if method not in _METHODS:
        raise ExperimentError(
            f"{table.where('method')}: found {quote(method)}, expected {', '.join(_METHODS)}"
            f"{did_you_mean(method, _METHODS)}"
        )
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
    low, high = table.number("from"), table.number("to")
    if low >= high:
        raise ExperimentError(f"{table.where()}: found {low:g} to {high:g}, expected from < to")
    if "step" in table.content:
        return low, high, table.number("step", above=0.0)
    if _read_scale(table) == "log":
        if low <= 0:
            raise ExperimentError(f"{table.where()}: a log scale needs from and to above 0")
        return loguniform(low, high)
    return low, high


def _read_scale(table: Table) -> str:
    scale = table.text("scale", default="linear")
    if scale not in _SCALES:
        raise ExperimentError(
            f"{table.where('scale')}: found {quote(scale)}, expected {' or '.join(_SCALES)}"
            f"{did_you_mean(scale, _SCALES)}"
        )
    return scale


def read_whole(table: Table, key: str) -> int:
    """The whole number under a key, 0 or more; raises ExperimentError: another number."""
    number = table.number(key)
    if number != int(number) or number < 0:
        raise ExperimentError(f"{table.where(key)}: found {number:g}, expected a whole number")
    return int(number)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)

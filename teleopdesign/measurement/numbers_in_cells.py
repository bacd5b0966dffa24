"""The cells of a column as numbers: numbers, dates, or texts of either."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError, quote
from .doors._cells import number_of, stamps_in_texts
from .encoder import Array
from .signed_numbers import MOST_BITS

#: whole numbers above are stamps in nanoseconds: 2^53, beyond which float64 skips some
_LONG = 2**MOST_BITS
#: cells that tell whether a column holds dates
_SOME = 100


def numbers_of(values: Any, column: str, file: str, channel: str = "") -> Array:
    """A column as float64 (n,), from numbers or dates of shape (n,), (n, 1) or (1, n).

    raises ExperimentError: more than one column, or a cell that is no number
    """
    values = np.asarray(values)
    begin = f"{file}: {channel}: column {quote(column)}" if channel else f"{file}: {quote(column)}"
    if values.ndim == 2 and 1 in values.shape:
        values = values.reshape(-1)
    if values.ndim != 1:
        raise ExperimentError(
            f"{begin}: found an array of shape {values.shape}, expected one column"
        )
    if values.dtype.kind in "mM":
        return _seconds(values)
    if values.dtype.kind in "iu" and len(values) and np.abs(values[0]) > _LONG:
        # as signed: of unsigned numbers, one below the first leaves a number near 2^64
        return np.asarray((values - values[0]).astype(np.int64), dtype=np.float64)
    if values.dtype.kind in "OU":
        values = _plain_objects(values.astype(object))
    if values.dtype.kind not in "fiub":
        row, text = _first_non_number(values)
        raise ExperimentError(f"{begin}, row {row}: found {text}, expected a number")
    numbers: Array = values.astype(np.float64)
    return numbers


def holds_dates(values: Any) -> bool:
    """Whether cells are dates, times of day or durations, also as texts: `numbers_of` gives s."""
    values = np.asarray(values)
    if values.dtype.kind in "mM":
        return True
    some = values.reshape(-1)[:_SOME].tolist() if values.dtype.kind in "OU" else []
    return bool(some) and stamps_in_texts(some) is not None


def _seconds(values: NDArray[Any]) -> Array:
    """Dates and durations in s from the first one; NaN in empty cells."""
    empty = np.isnat(values)
    filled = values[~empty]
    out = np.full(len(values), np.nan)
    if len(filled):
        out[~empty] = (filled - filled[0]) / np.timedelta64(1, "ns") * 1e-9
    return out


def _plain_objects(values: NDArray[Any]) -> NDArray[Any]:
    """Objects as numbers if all are numbers, texts of numbers or dates; None is an empty cell."""
    if any(isinstance(v, str) for v in values):
        stamps = stamps_in_texts(values.tolist())
        if stamps is not None:
            return stamps
        values = np.array([number_of(v) if isinstance(v, str) else v for v in values], dtype=object)
    if all(v is None or isinstance(v, int | float | np.number) for v in values):
        return np.array([np.nan if v is None else v for v in values], dtype=np.float64)
    if any(hasattr(v, "isoformat") for v in values):
        try:
            return _seconds(values.astype("datetime64[ns]"))
        except (TypeError, ValueError):
            return values
    return values


def _first_non_number(values: NDArray[Any]) -> tuple[int, str]:
    for row, value in enumerate(values, start=1):
        if not isinstance(value, int | float | np.number):
            return row, quote(str(value))
    return 1, f"values of type {values.dtype}"

"""Columns of a record file: .csv, .csv.gz, .parquet, .mat, .h5. Nothing is converted here."""

import zlib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ExperimentError, did_you_mean, quoted
from .csv_table import read_csv

Columns = dict[str, NDArray[np.float64]]
Wanted = Mapping[str, str]
"""Column -> the channel that wants it (for messages, "channels.position")."""


def read_columns(path: Path, file: str, wanted: Wanted) -> Columns:
    """The wanted columns of one file, each of shape (n,), as written.

    file: the file's name in messages ("rod/fit.csv.gz")
    raises ExperimentError: unknown kind of file, unreadable, column missing, not numbers, NaN or
    infinite (with column and row, counted from 1 without the header), columns of different length
    """
    readers = (read for ending, read in _READERS.items() if path.name.lower().endswith(ending))
    read = next(readers, None)
    if read is None:
        raise ExperimentError(
            f"{file}: found a file of kind {quoted(path.suffix)}, expected {', '.join(_READERS)}"
        )
    try:
        columns = read(path, file, wanted)
    except (OSError, EOFError, zlib.error) as problem:
        reason = getattr(problem, "strerror", None) or str(problem) or type(problem).__name__
        raise ExperimentError(f"{file}: cannot be read: {reason}") from None
    _refuse_different_lengths(columns, file, wanted)
    for column, values in columns.items():
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise ExperimentError(
                f"{file}: {wanted[column]}: column {quoted(column)}, row {bad[0] + 1}: "
                f"found {values[bad[0]]:g}, expected a finite number"
            )
    return columns


def require_columns(columns: Iterable[str], file: str, wanted: Wanted) -> None:
    """Raise an ExperimentError for the first wanted column that is not among those found."""
    columns = list(columns)
    for column, channel in wanted.items():
        if column not in columns:
            listed = ", ".join(columns[:20]) + (", ..." if len(columns) > 20 else "")
            raise ExperimentError(
                f"{file}: {channel}: no column {quoted(column)}, found {listed or 'no column'}"
                f"{did_you_mean(column, columns)}"
            )


def _read_csv(path: Path, file: str, wanted: Wanted) -> Columns:
    return read_csv(path, file, wanted, require_columns)


def _read_parquet(path: Path, file: str, wanted: Wanted) -> Columns:
    parquet = _optional("pyarrow.parquet", file)
    arrow = _optional("pyarrow", file)
    try:
        require_columns(parquet.read_schema(path).names, file, wanted)
        table = parquet.read_table(path, columns=list(wanted))
        arrays = {name: table.column(name).to_numpy() for name in wanted}
    except arrow.lib.ArrowException as problem:
        raise ExperimentError(f"{file}: not a readable parquet file: {problem}") from None
    return {name: _numbers(values, name, file, wanted) for name, values in arrays.items()}


def _read_mat(path: Path, file: str, wanted: Wanted) -> Columns:
    from scipy.io import loadmat, matlab, whosmat

    try:
        require_columns([name for name, _, _ in whosmat(path)], file, wanted)
        content = loadmat(path, variable_names=list(wanted))
    except NotImplementedError:  # version 7.3 is an HDF5 file
        return _read_h5(path, file, wanted)
    except (matlab.MatReadError, ValueError, TypeError, KeyError, IndexError) as problem:
        raise ExperimentError(f"{file}: not a readable MAT file: {problem}") from None
    return {name: _numbers(content[name], name, file, wanted) for name in wanted}


def _read_h5(path: Path, file: str, wanted: Wanted) -> Columns:
    h5py = _optional("h5py", file)
    with h5py.File(path, "r") as content:
        names: list[str] = []
        content.visititems(
            lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None
        )
        require_columns(names, file, wanted)
        return {name: _numbers(content[name][()], name, file, wanted) for name in wanted}


_READERS: dict[str, Callable[[Path, str, Wanted], Columns]] = {
    ".csv": _read_csv,
    ".csv.gz": _read_csv,
    ".parquet": _read_parquet,
    ".mat": _read_mat,
    ".h5": _read_h5,
}


def _optional(module: str, file: str) -> ModuleType:
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise ExperimentError(
            f'{file}: reading it needs {module.split(".")[0]}: pip install "teleopdesign[io]"'
        ) from None


def _numbers(values: Any, column: str, file: str, wanted: Wanted) -> NDArray[np.float64]:
    """A vector of float64 out of what a file holds: (n,), (n, 1) or (1, n) numbers."""
    values = np.asarray(values)
    begin = f"{file}: {wanted[column]}: column {quoted(column)}"
    if values.ndim == 2 and 1 in values.shape:
        values = values.reshape(-1)
    if values.ndim != 1:
        raise ExperimentError(
            f"{begin}: found an array of shape {values.shape}, expected one column"
        )
    if values.dtype.kind not in "fiub":
        row, text = _first_non_number(values)
        raise ExperimentError(f"{begin}, row {row}: found {text}, expected a number")
    numbers: NDArray[np.float64] = values.astype(np.float64)
    return numbers


def _first_non_number(values: NDArray[Any]) -> tuple[int, str]:
    for row, value in enumerate(values, start=1):
        if not isinstance(value, int | float | np.number):
            return row, quoted(str(value))
    return 1, f"values of type {values.dtype}"


def _refuse_different_lengths(columns: Columns, file: str, wanted: Wanted) -> None:
    if not columns:
        return
    first, *others = columns
    for other in others:
        if len(columns[other]) != len(columns[first]):
            raise ExperimentError(
                f"{file}: {wanted[other]}: column {quoted(other)} has {len(columns[other])} rows, "
                f"expected {len(columns[first])} as {quoted(first)}"
            )

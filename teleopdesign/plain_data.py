"""Results as plain data and as files: one way into JSON, and one way onto the disk.

A file is written beside its target and takes its name when it is whole: who reads it never meets
half a file, and what was there stays where writing fails.
"""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Iterator, Mapping, Set
from contextlib import contextmanager, suppress
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import numpy as np

from .errors import ExperimentError

if TYPE_CHECKING:
    import xarray

_TRIAL = 4096  # bytes of a trial of writing: one block, which a full disk does not have


def make_plain(value: object, *, digits: int | None = None) -> Any:
    """What JSON knows: mappings, lists, texts, numbers, true and false, null.

    Dataclasses become mappings in the order of their fields, arrays and tuples lists, sets sorted
    lists, paths texts; a number that is not finite becomes null.
    digits: significant digits that numbers of arrays keep; None: all of them
    raises TypeError: something else, by its type
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = dataclasses.fields(value)
        return {f.name: make_plain(getattr(value, f.name), digits=digits) for f in fields}
    if isinstance(value, Mapping):
        return {str(k): make_plain(v, digits=digits) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        listed = value.tolist()  # of a 0-dimensional array: its number
        return _round(listed, digits) if digits is not None else make_plain(listed)
    if isinstance(value, list | tuple):
        return [make_plain(v, digits=digits) for v in value]
    if isinstance(value, Set):
        return [make_plain(v, digits=digits) for v in sorted(value)]
    if value is None or isinstance(value, str):
        return value if value is None else str(value)
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, PurePath):
        return str(value)
    raise TypeError(f"plain data: found {type(value).__name__}, which has no form in JSON")


def json_text(data: object) -> str:
    """The data as JSON: one space a level, keys in their order, a line break at the end."""
    return json.dumps(make_plain(data), indent=1, allow_nan=False) + "\n"


def write_json(path: str | Path, data: object) -> None:
    """Write the data as JSON; raises ExperimentError where the file cannot be written."""
    write_text(path, json_text(data))


def write_text(path: str | Path, text: str) -> None:
    """Write a text in UTF-8 with line feeds; raises ExperimentError where that cannot be done."""
    with write_beside(path) as part:
        # backslashes: a file name that is no UTF-8 comes as halves of pairs, which UTF-8 lacks
        part.write_bytes(text.encode("utf-8", "backslashreplace"))


def write_netcdf(path: str | Path, data: xarray.Dataset) -> None:
    """Write a data set as netCDF; raises ExperimentError where the file cannot be written."""
    with write_beside(path) as part:
        data.to_netcdf(part)


@contextmanager
def write_beside(path: str | Path) -> Iterator[Path]:
    """A path beside `path` to write to, with the same ending; it becomes `path` at the end.

    Where writing fails `path` stays what it was, and nothing is left beside it.
    raises ExperimentError: the system refuses, in one line
    """
    try:
        target = Path(os.path.realpath(path))  # a link stays a link
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        raise ExperimentError(f"{path}: cannot be written: {error}") from error
    try:
        if target.exists() and not target.is_file():  # a folder is refused, a pipe just written to
            yield target
            return
        part = target.with_name(f".{uuid4().hex[:8]}.{target.name}")
        try:
            yield part
            if target.exists():
                part.chmod(target.stat().st_mode)
            os.replace(part, target)
        finally:
            with suppress(OSError):
                part.unlink()
    except OSError as error:
        raise ExperimentError(f"{path}: cannot be written: {error.strerror or error}") from error


def check_writable(path: str | Path) -> None:
    """Try whether `path` could be written, as `write_beside` does it; leaves what is there.

    raises ExperimentError: an unwritable folder, a full disk
    """
    try:
        target = Path(os.path.realpath(path))
        if target.exists() and not target.is_file():  # a pipe is opened once, for the result
            return
        part = target.with_name(f".{uuid4().hex[:8]}.{target.name}")
        try:
            with part.open("wb") as file:
                file.write(bytes(_TRIAL))
        finally:
            with suppress(OSError):
                part.unlink()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ExperimentError(f"{path}: cannot be written: {reason}") from error


def harmless_cell(text: str) -> str:
    """A text as a cell of a table, which no spreadsheet takes for a formula.

    What begins with = + - @, a tab or a carriage return is shown by spreadsheets as the result of
    a formula; an apostrophe in front makes it a text.
    """
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def _round(value: Any, digits: int) -> Any:
    if isinstance(value, list):
        return [_round(v, digits) for v in value]
    if isinstance(value, float) and math.isfinite(value):
        return float(f"{value:.{digits}g}")
    return make_plain(value)

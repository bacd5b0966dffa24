"""Results as plain data and as files: one function makes JSON, and one writes to the disk.

A file is written under another name beside its target and is renamed when it is complete. A reader
never meets an incomplete file, and the old file stays where writing fails.
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
    """The value as data that JSON can hold: mappings, lists, texts, numbers, true and false, null.

    Dataclasses become mappings in the order of their fields, arrays and tuples become lists, sets
    become sorted lists, and paths become texts. A number that is not finite becomes null.

    digits: significant digits that numbers of arrays keep; None: all of them
    raises TypeError: a value of another type, which the message names
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
    """The data as JSON: an indent of one space per level, a line break at the end."""
    return json.dumps(make_plain(data), indent=1, allow_nan=False) + "\n"


def write_json(path: str | Path, data: object) -> None:
    """Write the data as JSON; raises ExperimentError if the file cannot be written."""
    write_text(path, json_text(data))


def write_text(path: str | Path, text: str) -> None:
    """Write a text in UTF-8 with line feeds; raises ExperimentError if that fails."""
    with write_beside(path) as part:
        # backslashes: a file name that is no UTF-8 comes as halves of pairs, which UTF-8 lacks
        part.write_bytes(text.encode("utf-8", "backslashreplace"))


def write_netcdf(path: str | Path, data: xarray.Dataset) -> None:
    """Write a data set as netCDF; raises ExperimentError if the file cannot be written."""
    with write_beside(path) as part:
        data.to_netcdf(part)


@contextmanager
def write_beside(path: str | Path) -> Iterator[Path]:
    """A temporary path beside `path`, with the same ending; at the end the file becomes `path`.

    If writing fails, `path` stays unchanged and no temporary file is left.

    raises ExperimentError: the system refuses to write; the message is one line
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
    """Check whether `write_beside` could write `path`; a file that exists stays unchanged.

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
    """The text as a cell of a table which no spreadsheet takes for a formula.

    A spreadsheet evaluates a cell that begins with = + - @, a tab or a carriage return; an
    apostrophe in front makes the cell a text.
    """
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def _round(value: Any, digits: int) -> Any:
    if isinstance(value, list):
        return [_round(v, digits) for v in value]
    if isinstance(value, float) and math.isfinite(value):
        return float(f"{value:.{digits}g}")
    return make_plain(value)

"""Whole files, and results as plain data: one function makes JSON, and one writes to the disk.

A pipe that nobody writes into would stop a reader for ever, and a device such as /dev/zero would
fill the memory: reading has limits on waiting time and size. A pipe from a shell, `<(command)`, is
read like a file.

A file is written under another name beside its target and is renamed when it is complete. A reader
never meets an incomplete file, and the old file stays where writing fails.
"""

from __future__ import annotations

import dataclasses
import errno
import json
import math
import os
import select
from collections.abc import Iterator, Mapping, Set
from contextlib import contextmanager, suppress
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from .errors import ExperimentError

if TYPE_CHECKING:
    import xarray


#: most bytes of a file: an answer with all arrays has some MiB, and reading a larger one as JSON
#: would take gigabytes of memory
LARGEST = 1 << 28
#: s without a byte from a pipe that someone holds open
_PATIENCE = 10.0
_BLOCK = 1 << 20


def read_whole(path: str | Path, *, largest: int = LARGEST) -> bytes:
    """The bytes of a file.

    largest: limit on the number of bytes
    raises OSError: as `open` does; more bytes than `largest`; a pipe from which nothing comes
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    blocks, size = list[bytes](), 0
    with open(os.open(path, flags), "rb", buffering=0) as file:
        while (block := _next_block(file.fileno())) and size <= largest:
            blocks.append(block)
            size += len(block)
    if size > largest:
        raise OSError(errno.EFBIG, f"more than {largest >> 20} MiB")
    return b"".join(blocks)


def follow_links(path: Path) -> Path:
    """The path without symbolic links; a link in a ring stays, and is not a file then.

    `Path.resolve` raises RuntimeError there, and OSError from Python 3.13 on.
    """
    return Path(os.path.realpath(path))


def _next_block(file: int) -> bytes:
    while True:
        try:
            return os.read(file, _BLOCK)
        except BlockingIOError:
            if not select.select([file], [], [], _PATIENCE)[0]:
                raise OSError(errno.ETIMEDOUT, f"nothing came for {_PATIENCE:g} s") from None


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
    if hasattr(value, "dtype") and hasattr(value, "tolist"):  # an array, or a number of numpy
        listed = value.tolist()
        rounds = digits is not None and isinstance(listed, list)
        return _round(listed, digits) if rounds else make_plain(listed)
    if isinstance(value, list | tuple):
        return [make_plain(v, digits=digits) for v in value]
    if isinstance(value, Set):
        return [make_plain(v, digits=digits) for v in sorted(value)]
    if value is None or isinstance(value, str):
        return value if value is None else str(value)
    if isinstance(value, int):  # True and False are such numbers
        return value if isinstance(value, bool) else int(value)
    if isinstance(value, float):
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
    with _part_beside(path) as (target, part):
        yield part
        if part is not target:
            if target.exists():
                part.chmod(target.stat().st_mode)
            os.replace(part, target)


def check_writable(path: str | Path) -> None:
    """Check whether `write_beside` could write `path`; a file that exists stays unchanged.

    raises ExperimentError: an unwritable folder, a full disk
    """
    with _part_beside(path) as (target, part):
        if part is not target:  # a pipe is opened once, for the result
            part.write_bytes(bytes(_TRIAL))


@contextmanager
def _part_beside(path: str | Path) -> Iterator[tuple[Path, Path]]:
    """The file of a path, and a temporary path beside it: of a pipe or a folder, itself."""
    try:
        target = Path(os.path.realpath(path))  # a link stays a link
        is_file = target.is_file() or not target.exists()
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        raise ExperimentError(f"{path}: cannot be written: {error}") from error
    part = target.with_name(f".{uuid4().hex[:8]}.{target.name}") if is_file else target
    try:
        yield target, part
    except OSError as error:
        raise ExperimentError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        if is_file:
            with suppress(OSError):
                part.unlink()


def harmless_cell(text: str) -> str:
    """The text as a cell of a table which no spreadsheet takes for a formula.

    A spreadsheet evaluates a cell that begins with = + - @, a tab or a carriage return; an
    apostrophe in front makes the cell a text.
    """
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def _round(value: Any, digits: int | None) -> Any:
    if isinstance(value, list):
        return [_round(v, digits) for v in value]
    if isinstance(value, float) and math.isfinite(value):
        return float(f"{value:.{digits}g}")
    return make_plain(value)

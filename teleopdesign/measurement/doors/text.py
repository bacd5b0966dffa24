"""Tables of text: csv of any dialect, read fast if well-formed; if not, row and column are named.

What separates columns, the decimal sign, the encoding, comments before the header and a row of
units below it are read from the first rows. A time may be written as a date or a time of day.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path

import numpy as np

from ...errors import ExperimentError, quoted
from ._cells import CellColumns
from ._dialect import (
    COMMENTS,
    LOOKED_AT,
    SEPARATORS,
    Dialect,
    cells_of,
    dialect_of,
    open_bytes,
)
from ._log import MOST_BYTES, Array, Log, refuse_size

#: rows that are read at once: 20 MB of text
_ROWS = 200_000


def open_text(path: Path, file: str) -> Log:
    """A csv file, packed or not; raises ExperimentError: no text, no rows."""
    dialect = dialect_of(path, file)

    def read(wanted: Mapping[str, str]) -> Mapping[str, Array]:
        return _read(path, file, dialect, wanted)

    notes = []
    if dialect.separator != "," or dialect.comma:
        comma = ", decimal comma" if dialect.comma else ""
        notes.append(f"{SEPARATORS[dialect.separator]} between columns{comma}")
    if dialect.encoding not in ("utf-8", "utf-8-sig"):
        notes.append(f"text in {dialect.encoding}")
    if _is_cut_off(path, dialect):
        notes.append("a last row that was cut off")
    if not dialect.named:
        notes.append("no header: columns are named by their number")
    units = {n: u for n, u in zip(dialect.header, dialect.units, strict=False) if u}
    return Log(dialect.header, read, units, tuple(notes))


def _is_cut_off(path: Path, dialect: Dialect) -> bool:
    """Whether the last row of a file that is not packed has too few cells."""
    if path.name.lower().endswith(".gz") or dialect.separator == " ":
        return False
    with path.open("rb") as stream:
        stream.seek(0, 2)
        stream.seek(max(0, stream.tell() - LOOKED_AT))
        tail = stream.read().decode(dialect.encoding.removesuffix("-sig"), errors="ignore")
    lines = [line for line in tail.replace("\r", "\n").split("\n") if line.strip()]
    cells = cells_of(lines[-1], dialect.separator) if len(lines) > 1 else []
    return 0 < len(cells) < len(dialect.header)


def _read(path: Path, file: str, dialect: Dialect, wanted: Mapping[str, str]) -> dict[str, Array]:
    places = [_place(dialect.header, name, file) for name in wanted]
    try:
        with open_bytes(path) as raw, io.TextIOWrapper(raw, dialect.encoding) as stream:
            parts = [*_parts(_lines(stream, dialect, file), dialect.separator, places)]
        columns: dict[str, Array] = {}
        for name in wanted:  # a column at a time: its parts go when it is whole
            columns[name] = np.concatenate([part.pop(0) for part in parts])
        return columns
    except UnicodeDecodeError as problem:
        raise ExperimentError(
            f"{file}: not {dialect.encoding.upper()} text (byte {problem.start})"
        ) from None
    except ValueError:
        return _read_cell_by_cell(path, file, dialect, wanted, places)


def _parts(lines: Iterator[str], separator: str, places: Sequence[int]) -> Iterator[list[Array]]:
    """Columns of some rows at a time: a whole table beside its columns takes twice the memory."""
    yield [np.empty(0) for _ in places]  # of a header without rows
    while rows := list(islice(lines, _ROWS)):
        table = np.loadtxt(
            rows,
            delimiter=None if separator == " " else separator,
            comments=None,
            quotechar='"',
            usecols=places,
            ndmin=2,
        )
        yield [np.ascontiguousarray(table[:, k]) for k in range(len(places))]


def _place(header: Sequence[str], name: str, file: str) -> int:
    if header.count(name) > 1:
        raise ExperimentError(
            f"{file}: found {header.count(name)} columns {quoted(name)}, expected one"
        )
    return header.index(name)


def _lines(stream: Iterable[str], dialect: Dialect, file: str) -> Iterator[str]:
    """The rows of numbers with points as decimal signs; a row with more or fewer cells stops it."""
    width, separator = len(dialect.header), dialect.separator
    count = bytes_read = 0
    held = ""
    for k, line in enumerate(stream):
        if k < dialect.first or not line.strip():
            continue
        if line.lstrip().startswith(COMMENTS):
            continue
        if held:
            yield held
        bytes_read += len(line)
        count += 1
        if count % 100_000 == 0:
            refuse_size(count, file)
            if bytes_read > MOST_BYTES:
                raise ExperimentError(f"{file}: found over {MOST_BYTES:.2g} bytes of text")
        cells = width if separator == " " else line.count(separator) + 1
        if cells != width and '"' not in line:
            if cells < width:
                held = line
                break
            if cells == width + 1 and line.rstrip("\r\n").endswith(separator):
                line = line.rstrip("\r\n")[:-1] + "\n"
            else:
                raise _ragged(file, count, cells, width)
        held = line.replace(",", ".") if dialect.comma else line
    else:
        if held:
            yield held
        return
    # a last row that was cut off is left out; one in the middle is a mistake
    if any(line.strip() for line in stream):
        raise _ragged(file, count, cells, width)


def _ragged(file: str, row: int, cells: int, width: int) -> ExperimentError:
    return ExperimentError(
        f"{file}: row {row}: found {cells} cells, expected {width} as in the header"
    )


def _read_cell_by_cell(
    path: Path, file: str, dialect: Dialect, wanted: Mapping[str, str], places: Sequence[int]
) -> dict[str, Array]:
    """The slow way: empty cells are NaN, dates become seconds, other texts are named."""
    where = [
        f"{file}: {channel + ': ' if channel else ''}column {quoted(name)}"
        for name, channel in wanted.items()
    ]
    columns = CellColumns(where)
    with open_bytes(path) as raw, io.TextIOWrapper(raw, dialect.encoding) as stream:
        lines = _lines(stream, dialect, file)
        while rows := [cells_of(line, dialect.separator) for line in islice(lines, _ROWS)]:
            columns.add([[r[k] if k < len(r) else "" for r in rows] for k in places])
    return dict(zip(wanted, columns.values(), strict=True))

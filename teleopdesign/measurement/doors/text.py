"""Tables of text: csv of any dialect, read fast if well-formed; if not, row and column are named.

What separates columns, the decimal sign, the encoding, comments before the header and a row of
units below it are found from the first rows. A time may be written as a date or a time of day.
"""

from __future__ import annotations

import csv
import gzip
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import IO, cast

import numpy as np

from ...errors import ExperimentError, quoted
from ...quantity import is_unit
from ._cells import CellColumns, is_number, seconds_of
from ._log import MOST_BYTES, Array, Log, refuse_size

_COMMENTS = ("#", "%", "//")
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "spaces"}
#: bytes from which the dialect is read
_LOOKED_AT = 65_536
#: rows that are read at once: 20 MB of text
_ROWS = 200_000


@dataclass(frozen=True)
class Dialect:
    """How a table is written. `first`: line of the first row of numbers, from 0."""

    encoding: str
    separator: str
    comma: bool
    header: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    named: bool = True


def open_text(path: Path, file: str) -> Log:
    """A csv file, packed or not; raises ExperimentError: no text, no rows."""
    dialect = dialect_of(path, file)

    def read(wanted: Mapping[str, str]) -> Mapping[str, Array]:
        return _read(path, file, dialect, wanted)

    notes = []
    if dialect.separator != "," or dialect.comma:
        comma = ", decimal comma" if dialect.comma else ""
        notes.append(f"{_SEPARATORS[dialect.separator]} between columns{comma}")
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
        stream.seek(max(0, stream.tell() - _LOOKED_AT))
        tail = stream.read().decode(dialect.encoding.removesuffix("-sig"), errors="ignore")
    lines = [line for line in tail.replace("\r", "\n").split("\n") if line.strip()]
    cells = _cells(lines[-1], dialect.separator) if len(lines) > 1 else []
    return 0 < len(cells) < len(dialect.header)


def dialect_of(path: Path, file: str) -> Dialect:
    """How the file is written."""
    with _opened_bytes(path) as stream:
        raw = stream.read(_LOOKED_AT)
        whole = len(raw) < _LOOKED_AT
    encoding = _encoding(raw, file)
    text = raw.decode(encoding, errors="ignore").replace("\r\n", "\n").replace("\r", "\n")
    lines = text.split("\n")
    if not whole:
        lines = lines[:-1]
    if not any(line.strip() for line in lines):
        raise ExperimentError(
            f"{file}: found no header, expected a first row that names the columns"
        )
    body = [line for line in lines if line.strip() and not line.lstrip().startswith(_COMMENTS)]
    separator, comma = _separator(body[1:] or body)
    first = next(
        (
            k
            for k, line in enumerate(lines)
            if line.strip()
            and not line.lstrip().startswith(_COMMENTS)
            and _is_data(_cells(line, separator), comma)
        ),
        len(lines),
    )
    if first >= len(lines):
        _refuse_without_rows(lines, separator, file)
    width = len(_cells(lines[first], separator))
    header, units = _header(lines[:first], separator, width, lines[first])
    named = bool(header)
    if not named:
        header = tuple(f"column {k + 1}" for k in range(width))
    return Dialect(encoding, separator, comma, header, units, first, named)


def _refuse_without_rows(lines: Sequence[str], separator: str, file: str) -> None:
    filled = [line for line in lines if line.strip()]
    if len(filled) <= 1:
        raise ExperimentError(f"{file}: found a header and no rows, expected at least 64")
    cell = next((c for c in _cells(filled[1], separator) if c), "")
    raise ExperimentError(
        f"{file}: not a table of numbers: row 1: found {quoted(cell)}, expected a number"
    )


def _encoding(raw: bytes, file: str) -> str:
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    if raw[:3] == b"\xef\xbb\xbf":
        return "utf-8-sig"
    if b"\x00" in raw:
        raise ExperimentError(f"{file}: not a text (byte {raw.index(0)} is 0)")
    try:
        raw[: -4 if len(raw) > 4 else None].decode("utf-8")
        return "utf-8"
    except UnicodeDecodeError:
        return "cp1252" if not set(raw) & {0x81, 0x8D, 0x8F, 0x90, 0x9D} else "latin-1"


def _separator(lines: Sequence[str]) -> tuple[str, bool]:
    """The separator and whether the decimal sign is a comma: what leaves most numbers a row."""
    some = lines[-40:]
    best, chosen = (-1.0, 0), (",", False)
    for separator in _SEPARATORS:
        for comma in (False, True):
            if comma and separator == ",":
                continue
            rows = [_cells(line, separator) for line in some]
            widths = [len(row) for row in rows]
            width = max(set(widths), key=widths.count) if widths else 0
            cells = [c for row in rows for c in row if c]
            good = sum(_is_value(c, comma) for c in cells) / max(len(cells), 1)
            even = widths.count(width) / max(len(widths), 1)
            score = (round(good * even, 3), width)
            # one column of numbers is no better than several texts: a table has two
            if width > 1 and score > best:
                best, chosen = score, (separator, comma)
    return chosen


def _cells(line: str, separator: str) -> list[str]:
    line = line.strip("\r\n")
    if separator == " ":
        return line.split()
    if '"' in line:
        return [
            c.strip() for c in next(csv.reader([line], delimiter=separator, skipinitialspace=True))
        ]
    cells = [c.strip() for c in line.split(separator)]
    return cells


def _is_value(cell: str, comma: bool) -> bool:
    return is_number(cell, comma) or seconds_of(cell) is not None


def _is_data(cells: Sequence[str], comma: bool) -> bool:
    """A row of numbers and dates; a broken cell among many does not make it a header."""
    filled = [c for c in cells if c]
    return bool(filled) and sum(_is_value(c, comma) for c in filled) > 0.5 * len(filled)


def _header(
    before: Sequence[str], separator: str, width: int, row: str
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units from the lines before the first row of numbers."""
    plain = [line for line in before if line.strip()]
    rows = []
    for line in plain:
        text = line.lstrip()
        for mark in _COMMENTS:
            text = text.removeprefix(mark)
        cells = _cells(text.strip() if separator == " " else text.strip("\n"), separator)
        while len(cells) > width and not cells[-1]:
            cells = cells[:-1]
        if len(cells) == width:
            rows.append(tuple(cells))
    if not rows:
        last = plain[-1] if plain and not plain[-1].lstrip().startswith(_COMMENTS) else ""
        return (tuple(_cells(last, separator)) if last else ()), ()
    if len(rows) > 1 and all(_is_unit_cell(c) for c in rows[-1]) and any(rows[-1]):
        return rows[-2], tuple(c.strip("[]() ") for c in rows[-1])
    return rows[-1], ()


def _is_unit_cell(cell: str) -> bool:
    bare = cell.strip("[]() ")
    return not bare or bare in ("-", "counts", "ticks") or is_unit(bare)


def _opened_bytes(path: Path) -> IO[bytes]:
    if path.name.lower().endswith(".gz"):
        return cast(IO[bytes], gzip.open(path, "rb"))
    return path.open("rb")


def _read(path: Path, file: str, dialect: Dialect, wanted: Mapping[str, str]) -> dict[str, Array]:
    places = [_place(dialect.header, name, file) for name in wanted]
    try:
        with _opened_bytes(path) as raw, io.TextIOWrapper(raw, dialect.encoding) as stream:
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
        if line.lstrip().startswith(_COMMENTS):
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
    with _opened_bytes(path) as raw, io.TextIOWrapper(raw, dialect.encoding) as stream:
        lines = _lines(stream, dialect, file)
        while rows := [_cells(line, dialect.separator) for line in islice(lines, _ROWS)]:
            columns.add([[r[k] if k < len(r) else "" for r in rows] for k in places])
    return dict(zip(wanted, columns.values(), strict=True))

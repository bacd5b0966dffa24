"""Text tables: csv of any dialect, and sheets of workbooks (.xlsx), whose cells become such lines.

A well-formed table is read fast; errors name row and column.

The lines become plain rows (`_line_shapes`), the rows a table with a separator, a decimal sign and
names (`_dialect`), and the table signals with times (`shapes`).
"""

from __future__ import annotations

import datetime
import io
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import ExperimentError, quote
from ._cell_shapes import LineShape
from ._cells import part_of_column, parts_thousands
from ._dialect import LOOKED_AT, SEPARATORS, Dialect, cells_of, dialect_of, first_lines, open_bytes
from ._line_shapes import LINE_SHAPES
from ._log import MOST_BYTES, Log, join_names, optional, refuse_damage, refuse_size
from ._stray_lines import rows_of_numbers
from .shapes import best_shape, table_of
from .shapes._table import MOST_ROWS

#: rows that are read in one block: 20 MB of text
_ROWS = 200_000


@dataclass(frozen=True)
class _Text:
    """A text table: its source, how lines become rows, and how the rows are written.

    source: the path of a file, or all lines
    """

    source: Path | Sequence[str]
    file: str
    shape: LineShape
    dialect: Dialect

    @contextmanager
    def lines(self) -> Iterator[Iterable[str]]:
        if not isinstance(self.source, Path):
            yield self.shape.edit(self.source)
            return
        with (
            open_bytes(self.source) as raw,
            io.TextIOWrapper(raw, self.dialect.encoding, errors="replace") as stream,
        ):
            yield self.shape.edit(stream)

    def last_lines(self) -> list[str]:
        """The last lines with text, the first of them perhaps in part; none of a packed file."""
        if not isinstance(self.source, Path):
            return [*self.shape.edit(self.source[-MOST_ROWS:])]
        if self.source.name.lower().endswith(".gz"):
            return []
        with self.source.open("rb") as stream:
            size = stream.seek(0, 2)
            stream.seek(max(0, size - LOOKED_AT) & ~1)  # letters of UTF-16 have two bytes
            encoding = self.dialect.encoding.removesuffix("-sig")
            encoding = "utf-16-le" if encoding == "utf-16" and size > LOOKED_AT else encoding
            tail = stream.read().decode(encoding, errors="replace")
        lines = tail.replace("\r", "\n").split("\n")
        return [*self.shape.edit(line for line in lines if line.strip())]


def open_text(path: Path, file: str) -> Log:
    """Open a csv file, packed or not; raises ExperimentError: no text, no rows."""
    encoding, lines, whole = first_lines(path, file)
    return _open(path, lines, encoding, file, whole=whole)


def open_lines(lines: Sequence[str], file: str) -> Log:
    """Open the lines of a table; raises ExperimentError: no rows."""
    return _open(lines, lines[:MOST_ROWS], "utf-8", file, whole=len(lines) <= MOST_ROWS)


def _open(
    source: Path | Sequence[str], lines: Sequence[str], encoding: str, file: str, *, whole: bool
) -> Log:
    """Open a text;  lines: the first ones;  whole: whether these are all."""
    best: tuple[float, _Text, Mapping[str, Any]] | None = None
    problems: list[ExperimentError] = []
    shapes = [s for shape in LINE_SHAPES if (s := shape(lines, file)) is not None]
    for shape in shapes:
        edited = [*shape.edit(lines)]
        try:
            dialect = dialect_of(edited, encoding, file)
        except ExperimentError as problem:
            problems.append(problem)
            continue
        text = _Text(source, file, shape, dialect)
        some = edited[dialect.first :]
        if not whole and shape == LineShape():  # the last lines too: a signal may begin late
            some += text.last_lines()[1:]
        sample = _sample(some, dialect)
        points = best_shape(table_of(sample, {}))[1] if len(shapes) > 1 else 0.0
        if best is None or points > best[0]:
            above = edited[dialect.first - 1] if dialect.named else ""
            best = points, text, _without_blank_columns(sample, above, dialect)
    if best is None:
        raise problems[0]
    return _log_of(best[1], best[2])


def _log_of(text: _Text, sample: Mapping[str, Any]) -> Log:
    dialect, strays = text.dialect, list[int]()

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        strays.clear()
        return _read(text, [*wanted], strays)

    def left_out() -> tuple[str, ...]:
        lines = f"{len(strays)} lines that are no rows" if strays[1:] else "a line that is no row"
        return (f"{lines}, the first one before row {strays[0]}: left out",) if strays else ()

    notes = [text.shape.note] if text.shape.note else []
    separated = text.shape == LineShape() and isinstance(text.source, Path)
    if dialect.separator != "," and (separated or text.shape.units) or dialect.comma:
        comma = ", decimal comma" if dialect.comma else ""
        notes.append(f"{SEPARATORS[dialect.separator]} between columns{comma}")
    if dialect.encoding not in ("utf-8", "utf-8-sig"):
        notes.append(f"text in {dialect.encoding}")
    if not dialect.named:
        notes.append("no header: columns are named by their number")
    elif dialect.header[-1].endswith(f"(:,{len(dialect.header) - 1})"):
        notes.append(f"one name for an array: {quote(dialect.header[1])} and so on")
    units = {n: u for n, u in zip(dialect.header, dialect.units, strict=False) if u}
    units |= dict(text.shape.units)
    units |= dict.fromkeys(dialect.dates, "s")  # whatever the name says: "Timestamp [ms]"
    return Log(
        (*sample,),
        read,
        units,
        tuple(notes),
        left_out=left_out,
        remarks=dialect.remarks,
        sample=sample,
    )


def _sample(lines: Sequence[str], dialect: Dialect) -> dict[str, NDArray[Any]]:
    """The columns of some lines: the first rows, and where there are more, the last ones."""
    some = [*lines[:MOST_ROWS], *lines[MOST_ROWS:][-MOST_ROWS:]]
    cut = (cells_of(line, dialect.separator) for line in some if line.strip())
    rows = [row for row in cut if len(row) == len(dialect.header)]
    cells = zip(*rows, strict=True) if rows else ([] for _ in dialect.header)
    columns = (part_of_column(c, comma=dialect.comma) for c in cells)
    return dict(zip(dialect.header, columns, strict=True))


def _without_blank_columns(
    sample: Mapping[str, Any], above: str, dialect: Dialect
) -> Mapping[str, Any]:
    """The columns without the blank ones that spreadsheets write behind a table."""
    cells = cells_of(above, dialect.separator) if above else []
    if len(cells) != len(sample):
        return sample
    return {
        name: column
        for cell, (name, column) in zip(cells, sample.items(), strict=True)
        if cell or column.dtype.kind != "f" or np.any(np.isfinite(column))
    }


def _read(text: _Text, names: Sequence[str], strays: list[int]) -> dict[str, Any]:
    """Columns of a table: empty cells are NaN.

    A column with any text keeps it: `numbers_of` makes seconds of dates, or names the cell.
    raises ExperimentError: points in numbers of which others have a decimal comma
    """
    dialect = text.dialect
    places = [dialect.header.index(name) for name in names]
    blocks: list[list[NDArray[Any]]] = [[] for _ in places]
    with text.lines() as stream:
        lines = rows_of_numbers(stream, dialect, text.file, strays)
        while block := list(islice(lines, _ROWS)):
            for column, part in zip(blocks, _columns_of(block, dialect, places), strict=True):
                column.append(part)
    columns = {}
    for name, column in zip(names, blocks, strict=True):
        columns[name] = np.concatenate(column) if column else np.empty(0)
        if dialect.comma and (where := parts_thousands(columns[name])):
            row, cell = where
            raise ExperimentError(
                f"{text.file}: column {quote(name)}, row {row}: found {quote(cell)}, expected a "
                "number with a decimal comma, for that of other cells is one: is the point a "
                "decimal sign, or does it part thousands? Write it without"
            )
        column.clear()  # one column at a time, to free its parts
    return columns


def _columns_of(
    lines: Sequence[str], dialect: Dialect, places: Sequence[int]
) -> list[NDArray[Any]]:
    """The columns at some places of a few rows: plain numbers at once, else cell by cell."""
    separator, comma = dialect.separator, dialect.comma
    if not comma or not any("." in line for line in lines):  # else points may part thousands
        try:
            table = np.loadtxt(
                [line.replace(",", ".") for line in lines] if comma else lines,
                delimiter=None if separator == " " else separator,
                comments=None,
                quotechar='"',
                usecols=places,
                ndmin=2,
            )
            return [np.ascontiguousarray(table[:, k]) for k in range(len(places))]
        except ValueError:
            pass
    plain = separator != " " and not any('"' in line for line in lines)
    rows = [line.split(separator) if plain else cells_of(line, separator) for line in lines]
    cells = ([r[place] if place < len(r) else "" for r in rows] for place in places)
    return [part_of_column(column, comma=comma) for column in cells]


def open_workbook(path: Path, file: str) -> Log:
    """Open a workbook; raises ExperimentError: a damaged or too large file, no row of numbers."""
    openpyxl = optional("openpyxl", file)
    with refuse_damage("workbook", file):
        with zipfile.ZipFile(path) as packed:
            size = sum(entry.file_size for entry in packed.infolist())
        if size > MOST_BYTES // 4:
            raise ExperimentError(
                f"{file}: found {size:.3g} bytes unpacked, expected a smaller table"
            )
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        sheets = {
            s.title: ["\t".join(map(_text, row)) for row in s.iter_rows(values_only=True)]
            for s in book.worksheets
        }
        book.close()
    tables: dict[str, Log] = {}
    for title, lines in sheets.items():
        refuse_size(len(lines), file)
        try:
            tables[title] = open_lines([line for line in lines if line.strip()], file)
        except ExperimentError:  # a sheet of texts, or empty
            continue
    if not tables:
        raise ExperimentError(f"{file}: found no sheet with a table of numbers below its header")
    title, *others = tables
    log = tables[title]
    notes = [f"sheet {title!r}"] if len(sheets) > 1 else []
    if others:
        sheet = "sheet" if len(others) == 1 else "sheets"
        others = [repr(other) for other in others]
        notes.append(f"{sheet} {join_names(others, 4)}: left out; save each as a file of its own")
    return replace(log, notes=(*notes, *log.notes))


def _text(cell: Any) -> str:
    """A cell as a text table holds it: durations as a time of day, which may have days."""
    if isinstance(cell, bool):
        return str(int(cell))
    if isinstance(cell, datetime.datetime):
        return cell.isoformat()
    if isinstance(cell, datetime.timedelta):
        minutes, seconds = divmod(cell.seconds + 1e-6 * cell.microseconds, 60)
        return f"{cell.days} days {minutes // 60:02.0f}:{minutes % 60:02.0f}:{seconds:09.6f}"
    return "" if cell is None else " ".join(str(cell).replace('"', "'").split())

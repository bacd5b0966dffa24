"""Text tables: csv of any dialect. A well-formed table is read fast; errors name row and column.

Separator, decimal sign, encoding, comments before the header and a row of units below it are judged
from the first rows. A time may be written as a date or a time of day.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np

from ...base.errors import ExperimentError, quote
from ._cells import CellColumns, is_empty
from ._clock_before_signal import clocks_before_signals, with_clocks_before
from ._dialect import (
    COMMENTS,
    SEPARATORS,
    Dialect,
    cells_of,
    dialect_of,
    first_lines,
    is_value,
    without_end,
)
from ._frames import refuse_frames
from ._in_turn import turns_of, with_machines_apart
from ._lines_of_file import (
    are_stamped,
    edit_of,
    is_cut_off,
    last_lines,
    open_lines,
    with_stamps_as_cells,
)
from ._log import MOST_BYTES, Array, Log, join_names, refuse_size
from ._pairs import log_of_pairs, names_in_lines
from ._reading_in_each_row import open_reading_in_each_row
from ._signals_in_rows import open_signals_in_rows
from ._signals_in_turn import has_signals_in_turn, log_of_signals_in_turn
from ._sparse import groups_of, with_separate_clocks
from ._two_part_time import with_whole_time
from ._units_in_cells import UnitCells

#: rows that are read in one block: 20 MB of text
_ROWS = 200_000
#: most lines that are no rows (messages of a logger that restarts, a garbled row), as a number and
#: as a part of the rows, that are left out. More such lines mean that the table has another form
FEW_STRAYS, MOST_STRAYS = 10, 0.01
_BEGINS_A_NUMBER = (*'0123456789+-.,;|\t"',)


def open_text(path: Path, file: str) -> Log:
    """Open a csv file, packed or not; raises ExperimentError: no text, no rows."""
    if (turned := open_signals_in_rows(path, file)) is not None:
        return turned
    encoding, lines = first_lines(path, file)
    refuse_frames(lines, file)
    stamped = are_stamped(lines)
    if pairs := names_in_lines([*with_stamps_as_cells(lines, "=")] if stamped else lines):
        return log_of_pairs(path, file, encoding, pairs, stamped=stamped)
    if has_signals_in_turn(lines):
        return log_of_signals_in_turn(path, file, encoding)
    if (log := open_reading_in_each_row(path, file, encoding, lines)) is not None:
        return log
    edit, notes = edit_of(lines)
    lines = [*edit(lines)]
    dialect = replace(dialect_of(lines, encoding, file), edit=edit)
    strays: list[int] = []

    def read(wanted: Mapping[str, str]) -> Mapping[str, Array]:
        strays.clear()
        return _read(path, file, dialect, wanted, strays)

    def left_out() -> tuple[str, ...]:
        lines = f"{len(strays)} lines that are no rows" if strays[1:] else "a line that is no row"
        return (f"{lines}, the first one before row {strays[0]}: left out",) if strays else ()

    if dialect.separator != "," or dialect.comma:
        comma = ", decimal comma" if dialect.comma else ""
        notes.append(f"{SEPARATORS[dialect.separator]} between columns{comma}")
    if dialect.encoding not in ("utf-8", "utf-8-sig"):
        notes.append(f"text in {dialect.encoding}")
    if is_cut_off(path, dialect):
        notes.append("a last row that was cut off")
    if not dialect.named:
        notes.append("no header: columns are named by their number")
    elif dialect.header[-1].endswith(f"(:,{len(dialect.header) - 1})"):
        notes.append(f"one name for an array: {quote(dialect.header[1])} and so on")
    units = {n: u for n, u in zip(dialect.header, dialect.units, strict=False) if u}
    units |= edit.units if isinstance(edit, UnitCells) else {}
    units |= dict.fromkeys(dialect.dates, "s")  # whatever the name says: "Timestamp [ms]"
    # the last lines too: a signal may begin late; those of a short file are its first ones again
    top, first = {*lines[: dialect.first]}, lines[dialect.first :]
    some = [*first, *(line for line in last_lines(path, dialect)[1:] if line not in top)]
    above = cells_of(lines[dialect.first - 1], dialect.separator) if dialect.named else []
    names = _without_blank_columns(dialect.header, above, _rows_of(some, dialect))
    log = Log(names, read, units, tuple(notes), left_out=left_out, remarks=dialect.remarks)
    time, groups = groups_of(dialect.header, _rows_of(some, dialect))
    if groups:
        return with_separate_clocks(log, file, time, groups)
    if not dialect.named:
        whole = all(cell.isdigit() for row in _rows_of(first, dialect) for cell in row[:2])
        return with_whole_time(log, file, named=False) if whole else log
    if clock_of := clocks_before_signals(log.names, _rows_of(first, dialect), dialect.comma):
        return with_clocks_before(log, file, clock_of)
    turns = turns_of(log.names, _rows_of(first, dialect), dialect.comma)
    if turns is not None:
        return with_machines_apart(log, turns, lambda name: _texts(path, file, dialect, name))
    return with_whole_time(log, file)


def _rows_of(lines: Iterable[str], dialect: Dialect) -> Iterator[list[str]]:
    """The cells of each line, one after another: as lists they take ten times the text."""
    return (cells_of(line, dialect.separator) for line in lines if line.strip())


def _without_blank_columns(
    header: tuple[str, ...], above: Sequence[str], rows: Iterable[Sequence[str]]
) -> tuple[str, ...]:
    """The names of the columns without those that spreadsheets write behind a table: all blank.

    above: the line above the rows, which also leaves their names blank
    """
    if len(above) != len(header):
        return header
    blank = {i for i, cell in enumerate(above) if not cell}
    for row in rows:
        if not blank:
            return header
        if len(row) == len(header):
            blank -= {i for i in blank if row[i]}
    return tuple(name for i, name in enumerate(header) if i not in blank)


def _texts(path: Path, file: str, dialect: Dialect, name: str) -> list[str]:
    """The cells of a column as text, one for each row that is read."""
    place = dialect.header.index(name)
    with open_lines(path, dialect.encoding, dialect.edit) as stream:
        lines = _lines(stream, dialect, file, [])
        return [cells_of(line, dialect.separator)[place] for line in lines]


def _read(
    path: Path, file: str, dialect: Dialect, wanted: Mapping[str, str], strays: list[int]
) -> dict[str, Array]:
    places = [_place(dialect.header, name, file) for name in wanted]
    try:
        with open_lines(path, dialect.encoding, dialect.edit) as stream:
            lines = _lines(stream, dialect, file, strays)
            if dialect.comma:
                lines = _with_points(lines, dialect.separator, places)
            parts = [*_parts(lines, dialect.separator, places)]
        columns: dict[str, Array] = {}
        for name in wanted:  # one column at a time, to free its parts
            columns[name] = np.concatenate([part.pop(0) for part in parts])
        return columns
    except UnicodeDecodeError as problem:
        raise ExperimentError(
            f"{file}: not {dialect.encoding.upper()} text (byte {problem.start})"
        ) from None
    except ValueError:
        strays.clear()
        return _read_cell_by_cell(path, file, dialect, wanted, places, strays)


def _parts(lines: Iterator[str], separator: str, places: Sequence[int]) -> Iterator[list[Array]]:
    """Columns of some rows at a time: a whole table beside its columns would double the memory."""
    yield [np.empty(0) for _ in places]  # for a table without rows
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
            f"{file}: found {header.count(name)} columns {quote(name)}, expected one"
        )
    return header.index(name)


def _lines(stream: Iterable[str], dialect: Dialect, file: str, strays: list[int]) -> Iterator[str]:
    """The lines of the table that are rows of numbers.

    strays: gets the number of the row before which a line was left out; such a line has too few
        cells or no number in any cell
    raises ExperimentError: a row with too many cells; too many lines that are no rows
    """
    width, separator = len(dialect.header), dialect.separator
    count = bytes_read = again = 0
    cut = False  # whether the last line was left out: the last line of a file may be incomplete
    for k, line in enumerate(stream):
        bare = line.lstrip()
        if k < dialect.first or not bare or bare.startswith(COMMENTS):
            continue
        bytes_read += len(line)
        if (count + again + 1) % 100_000 == 0:
            refuse_size(count + again + 1, file)
            if bytes_read > MOST_BYTES:
                raise ExperimentError(f"{file}: found over {MOST_BYTES:.2g} bytes of text")
        line = without_end(line, separator)
        if dialect.labels and _is_header_again(line, dialect):
            strays.append(count + 1)
            again, cut = again + 1, False
            continue
        count += 1
        cells = len(line.split()) if separator == " " else line.count(separator) + 1
        quoted_cells = '"' in line and separator != " "
        if cut := cells < width and not quoted_cells or _is_text(line, dialect):
            strays.append(count)
            count -= 1
            if len(strays) - again > max(FEW_STRAYS, MOST_STRAYS * count):
                raise _ragged_row_error(file, strays[0], cells, width)
            continue
        if cells > width and not quoted_cells and separator != " ":
            if cells > width + 1 or not line.rstrip("\r\n").endswith(separator):
                nameless = _text_without_name(line, dialect) if count == 1 else ""
                raise _ragged_row_error(file, count, cells, width, nameless)
            line = line.rstrip("\r\n")[:-1] + "\n"
        yield line
    if cut:
        strays.pop()  # reported as an incomplete row


def _with_points(lines: Iterator[str], separator: str, places: Sequence[int]) -> Iterator[str]:
    """Rows with points in place of decimal commas.

    raises ValueError: a point in a wanted cell, where it may separate thousands
    """
    for line in lines:
        if "." in line and any("." in c for c in pick(cells_of(line, separator), places)):
            raise ValueError(line)
        yield line.replace(",", ".")


def pick(cells: Sequence[str], places: Sequence[int]) -> list[str]:
    """The cells of a row at some places; "" where the row is shorter."""
    return [cells[k] if k < len(cells) else "" for k in places]


def _is_text(line: str, dialect: Dialect) -> bool:
    """Whether a line holds no number at all: a repeated header or a message of the logger."""
    if line.lstrip()[:1] in _BEGINS_A_NUMBER:
        return False
    cells = [c for c in cells_of(line, dialect.separator) if c]
    return not any(is_value(c, dialect.comma) or is_empty(c) for c in cells)


def _is_header_again(line: str, dialect: Dialect) -> bool:
    """Whether a line is one of a header that repeats: before each block of rows, as of LabVIEW."""
    if line.lstrip()[:1] in _BEGINS_A_NUMBER:
        return False
    return cells_of(line, dialect.separator)[0] in dialect.labels


def _ragged_row_error(
    file: str, row: int, cells: int, width: int, more: str = ""
) -> ExperimentError:
    return ExperimentError(
        f"{file}: row {row}: found {cells} cells, expected {width} as in the header{more}"
    )


def _text_without_name(line: str, dialect: Dialect) -> str:
    """What to do about the first row's texts, such as a tag before its numbers; "" without one."""
    cells = cells_of(line, dialect.separator)
    texts = [k for k, c in enumerate(cells) if not is_value(c, dialect.comma) and not is_empty(c)]
    if not texts or len(cells) != len(dialect.header) + 1:
        return ""
    where = join_names([f"{quote(cells[k])} in cell {k + 1}" for k in texts], most=3)
    return f"; the header may leave out the name of a text ({where}): write it there"


def _read_cell_by_cell(
    path: Path,
    file: str,
    dialect: Dialect,
    wanted: Mapping[str, str],
    places: Sequence[int],
    strays: list[int],
) -> dict[str, Array]:
    """Read each cell separately, which is slow: empty cells are NaN, dates become seconds.

    raises ExperimentError: any other text, with its row and column
    """
    where = [
        f"{file}: {channel + ': ' if channel else ''}column {quote(name)}"
        for name, channel in wanted.items()
    ]
    columns = CellColumns(where, comma=dialect.comma)
    with open_lines(path, dialect.encoding, dialect.edit) as stream:
        lines = _lines(stream, dialect, file, strays)
        while rows := [cells_of(line, dialect.separator) for line in islice(lines, _ROWS)]:
            columns.add(
                [list(column) for column in zip(*(pick(r, places) for r in rows), strict=True)]
            )
    return dict(zip(wanted, columns.values(), strict=True))

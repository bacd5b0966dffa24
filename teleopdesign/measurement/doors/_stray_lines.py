"""The rows of a text table, without lines that are none: messages, repeated headers, cut rows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import Literal

from ...base.errors import ExperimentError, quote
from ..limits import SEVERAL
from ._cells import is_empty
from ._dialect import COMMENTS, Dialect, cells_of, is_value, without_end
from ._log import MOST_BYTES, refuse_size

#: most lines that are no rows (messages of a logger that restarts, a garbled row), as a number and
#: as a part of the rows, that are left out. More such lines mean that the table has another form
FEW_STRAYS, MOST_STRAYS = 10, 0.01
#: lines that are looked at together, and with what a row of plain numbers begins
_BLOCK, _BEGINS_A_ROW = 5_000, frozenset("0123456789+-.")
_BEGINS_A_NUMBER = (*'0123456789+-.,;|\t"',)


def rows_of_numbers(
    stream: Iterable[str], dialect: Dialect, file: str, strays: list[int]
) -> Iterator[str]:
    """The lines of the table that are rows of numbers.

    strays: gets the number of the row before which a line was left out; such a line has too few
        cells or no number in any cell
    raises ExperimentError: a row with too many cells; too many lines that are no rows
    """
    width, separator = len(dialect.header), dialect.separator
    count = bytes_read = again = 0
    lines_read = 0
    lines_of = iter(stream)
    while lines := list(islice(lines_of, _BLOCK)):
        begin, lines_read = lines_read, lines_read + len(lines)
        bytes_read += sum(map(len, lines))
        refuse_size(count + again, file)
        if bytes_read > MOST_BYTES:
            raise ExperimentError(f"{file}: found over {MOST_BYTES:.2g} bytes of text")
        if begin >= dialect.first and _are_plain_rows(lines, dialect):
            count += len(lines)
            yield from lines
            continue
        for k, line in enumerate(lines, begin):
            bare = line.lstrip()
            if k < dialect.first or not bare or bare.startswith(COMMENTS):
                continue
            line = without_end(line, separator)
            kind = _kind_of(line, dialect)
            if kind == "other header":
                raise ExperimentError(
                    f"{file}: after row {count}: found other names or units of columns, "
                    f"{quote(line.strip())}: give each table a file of its own"
                )
            if kind == "header again":
                strays.append(count + 1)
                again += 1
                continue
            count += 1
            cells = len(line.split()) if separator == " " else line.count(separator) + 1
            quoted_cells = '"' in line and separator != " "
            if cells < width and not quoted_cells or kind == "text":
                strays.append(count)
                count -= 1
                if len(strays) - again > max(FEW_STRAYS, MOST_STRAYS * count):
                    raise ragged_row_error(file, strays[0], cells, width)
                continue
            if cells > width and not quoted_cells and separator != " ":
                if cells > width + 1 or not line.rstrip("\r\n").endswith(separator):
                    raise ragged_row_error(file, count, cells, width)
                line = line.rstrip("\r\n")[:-1] + "\n"
            yield line


def _are_plain_rows(lines: Sequence[str], dialect: Dialect) -> bool:
    """Whether all of some lines are rows of plain numbers: nearly all lines of most files."""
    separator = dialect.separator
    if separator == " " or not {line[:1] for line in lines} <= _BEGINS_A_ROW:
        return False
    cells = {line.count(separator) + 1 for line in lines}
    odd, text = ('"', *";" * (separator != ";")), "".join(lines)
    return cells == {len(dialect.header)} and not any(x in text for x in odd)


def _kind_of(line: str, dialect: Dialect) -> Literal["row", "text", "header again", "other header"]:
    """What a line of a table is: a row of numbers, or none.

    A text holds no number, as a message of the logger. A header repeats before each block of rows,
    as of LabVIEW. Another one gives each column a word and is none of the lines above the table: of
    two columns, a message may do that too.
    """
    if line.lstrip()[:1] in _BEGINS_A_NUMBER:
        return "row"
    cells = cells_of(line, dialect.separator)
    texts = [c for c in cells if not (is_empty(c) or is_value(c, dialect.comma))]
    named = dialect.named and dialect.separator != " " and len(cells) >= SEVERAL
    if named and len(texts) == len(cells) == len(dialect.header):
        if all(cells != cells_of(above, dialect.separator) for above in dialect.remarks):
            return "other header"
    if cells[0] in dialect.labels:
        return "header again"
    return "text" if len(texts) == sum(map(bool, cells)) else "row"


def ragged_row_error(file: str, row: int, cells: int, width: int) -> ExperimentError:
    return ExperimentError(
        f"{file}: row {row}: found {cells} cells, expected {width} as in the header"
    )

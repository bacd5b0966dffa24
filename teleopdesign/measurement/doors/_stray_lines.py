"""Lines of a text table that are no rows: messages, repeated headers, rows of another width."""

from __future__ import annotations

from ...base.errors import ExperimentError, quote
from ._cells import is_empty
from ._dialect import Dialect, cells_of, is_value
from ._log import join_names

_BEGINS_A_NUMBER = (*'0123456789+-.,;|\t"',)


def is_text(line: str, dialect: Dialect) -> bool:
    """Whether a line holds no number at all: a repeated header or a message of the logger."""
    if line.lstrip()[:1] in _BEGINS_A_NUMBER:
        return False
    cells = [c for c in cells_of(line, dialect.separator) if c]
    return not any(is_value(c, dialect.comma) or is_empty(c) for c in cells)


def is_header_again(line: str, dialect: Dialect) -> bool:
    """Whether a line is one of a header that repeats: before each block of rows, as of LabVIEW."""
    if line.lstrip()[:1] in _BEGINS_A_NUMBER:
        return False
    return cells_of(line, dialect.separator)[0] in dialect.labels


def ragged_row_error(
    file: str, row: int, cells: int, width: int, more: str = ""
) -> ExperimentError:
    return ExperimentError(
        f"{file}: row {row}: found {cells} cells, expected {width} as in the header{more}"
    )


def text_without_name(line: str, dialect: Dialect) -> str:
    """What to do about the first row's texts, such as a tag before its numbers; "" without one."""
    cells = cells_of(line, dialect.separator)
    texts = [k for k, c in enumerate(cells) if not is_value(c, dialect.comma) and not is_empty(c)]
    if not texts or len(cells) != len(dialect.header) + 1:
        return ""
    where = join_names([f"{quote(cells[k])} in cell {k + 1}" for k in texts], most=3)
    return f"; the header may leave out the name of a text ({where}): write it there"

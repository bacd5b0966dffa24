"""Cells of a text table as numbers: plain numbers, dates and times of day."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._dates import stamps_of
from ._log import Array

#: a number. Possessive quantifiers ("++") match digits once, so that a cell of a million digits and
#: a letter needs no time
_NUMBER = re.compile(
    r"[-+]?(\d++(?:\.\d*+)?|\.\d++)([ed][-+]?\d++)?$|[-+]?(nan|inf|infinity)$", re.I
)
#: a number with commas between thousands, as spreadsheets print it: "1,000.0". A single comma
#: without a point, "1,000", may be a decimal comma and does not match
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:(?:,\d{3})++\.\d*+|(?:,\d{3}){2,})$")
#: the same with points between thousands and a decimal comma: "1.234,5". Points without a comma,
#: "1.234", do not match
_THOUSANDS_WITH_POINTS = re.compile(r"[-+]?[1-9]\d{0,2}(?:\.\d{3})++,\d*+$")
#: texts for a missing reading in loggers and tables, in lower case
NO_READING = frozenset(
    "n/a na n.a. #n/a #na null none nil - -- --- ? * . missing invalid "
    "#value! #div/0! #num! #ref!".split()
)


def is_empty(cell: str) -> bool:
    """Whether a cell holds no reading: empty, or a word for a missing value ("n/a", "-")."""
    bare = cell.strip()
    return not bare or bare.lower() in NO_READING


def is_number(cell: str, comma: bool) -> bool:
    """Whether a cell is a number; comma: the decimal sign is a comma, not a point."""
    if (_THOUSANDS_WITH_POINTS if comma else _THOUSANDS).match(cell):
        return True
    return bool(_NUMBER.match(cell.replace(",", ".") if comma else cell))


def number_of(cell: str, *, comma: bool = False) -> float | str:
    """A cell as a number: NaN if it holds no reading; the cell unchanged if it is a text.

    comma: the decimal sign is a comma, and points may separate thousands
    """
    text = cell = cell.strip()
    if is_empty(cell):
        return math.nan
    if comma:
        if "." in cell and not _THOUSANDS_WITH_POINTS.match(cell):
            return text
        cell = cell.replace(".", "").replace(",", ".")
    if _THOUSANDS.match(cell):
        cell = cell.replace(",", "")
    if not _NUMBER.match(cell):
        return text
    return float(cell.replace("d", "e").replace("D", "e") if "n" not in cell.lower() else cell)


def seconds_of(cell: str) -> float | None:
    """A date or a time of day in s; None: the cell is neither."""
    if ":" not in cell and max(map(cell.count, "-/.")) < 2:
        return None
    stamp = stamps_of([cell])
    return None if stamp is None else float(stamp[0])


def stamps_in_texts(cells: Sequence[object]) -> Array | None:
    """Dates or times of day of a column in s, NaN in empty cells; None: another content."""
    filled = [k for k, cell in enumerate(cells) if cell is not None and not is_empty(str(cell))]
    texts = [cell for k in filled if isinstance(cell := cells[k], str)]
    if not texts or len(texts) < len(filled) or seconds_of(texts[0]) is None:
        return None
    stamps = stamps_of(texts)
    if stamps is None:
        return None
    out = np.full(len(cells), np.nan)
    out[filled] = stamps
    return out


def column_of(parts: Sequence[NDArray[Any]], *, comma: bool = False) -> NDArray[Any]:
    """A column from its parts (`part_of_column`): numbers (n,), dates in s, or cells with texts."""
    column = np.concatenate(parts) if parts else np.empty(0)
    if column.dtype.kind == "f" or is_column_of_texts(column, comma=comma):
        return column
    texts = [cell.replace(",", ".") if comma and isinstance(cell, str) else cell for cell in column]
    stamps = stamps_in_texts([None if cell != cell else cell for cell in texts])
    return column if stamps is None else stamps


def part_of_column(cells: Sequence[str], *, comma: bool = False) -> NDArray[Any]:
    """Some cells of a column as numbers, which need less memory, or as texts.

    comma: the decimal sign is a comma
    """
    if is_column_of_texts(cells, comma=comma):
        return np.array([cell.strip() for cell in cells], dtype=object)
    return _numbers_or_cells(cells, comma)


def is_column_of_texts(cells: Iterable[Any], *, comma: bool = False) -> bool:
    """Whether a column begins with a text that is neither a number nor a date."""
    first = next((c for c in cells if c is not None and not is_empty(str(c))), 0.0)
    return isinstance(first, str) and not is_number(first, comma) and seconds_of(first) is None


def _numbers_or_cells(cells: Sequence[str], comma: bool) -> NDArray[Any]:
    if not comma and not any("_" in cell for cell in cells):
        try:
            return np.array(cells, dtype=np.float64)  # ten times as fast
        except ValueError:
            pass
    values = [number_of(cell, comma=comma) for cell in cells]
    texts = any(isinstance(value, str) for value in values)
    return np.array(values, dtype=object if texts else np.float64)


def parts_thousands(column: NDArray[Any]) -> tuple[int, str] | None:
    """Row (from 1) and cell of a number with points that may part thousands, if there is one."""
    cells = enumerate(column, 1) if column.dtype.kind == "O" else ()
    return next(((k, c) for k, c in cells if isinstance(c, str) and _NUMBER.match(c)), None)

"""Cells of a text table as numbers: plain numbers, dates and times of day."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from ...base.errors import ExperimentError, quote
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

_NO_ROWS = np.empty(0)


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
    cell = cell.strip()
    if is_empty(cell):
        return math.nan
    if comma:
        if "." in cell and not _THOUSANDS_WITH_POINTS.match(cell):
            return cell
        cell = cell.replace(".", "").replace(",", ".")
    if _THOUSANDS.match(cell):
        cell = cell.replace(",", "")
    if not _NUMBER.match(cell):
        return cell
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


class CellColumns:
    """Columns of texts, converted to numbers block by block because texts need more memory.

    A column that begins with a text which is no number is kept until it is complete: its dates
    count from the first one.
    """

    def __init__(self, where: Sequence[str], *, comma: bool = False) -> None:
        """where: name of each column in error messages;  comma: the decimal sign is a comma."""
        self._where, self._comma = where, comma
        self._numbers: list[list[Array]] = [[] for _ in where]
        self._texts: list[list[str]] = [[] for _ in where]
        self._rows = 0

    def add(self, columns: Sequence[list[str]]) -> None:
        """Add the cells of the next rows; raises ExperimentError: a cell that is no number."""
        for k, cells in enumerate(columns):
            if self._texts[k] or (self._rows == 0 and _begins_with_text(cells, self._comma)):
                self._texts[k] += cells
            else:
                self._numbers[k].append(_numbers(cells, self._where[k], self._comma, self._rows))
        self._rows += len(columns[0])

    def values(self) -> list[Array]:
        """The columns as arrays; raises ExperimentError: a column of neither numbers nor dates."""
        return [
            _seconds_or_numbers(texts, where, self._comma)
            if texts
            else np.concatenate([_NO_ROWS, *numbers])
            for texts, numbers, where in zip(self._texts, self._numbers, self._where, strict=True)
        ]


def _begins_with_text(cells: Sequence[str], comma: bool) -> bool:
    filled = next((c for c in cells if not is_empty(c)), "")
    return bool(filled) and not is_number(filled, comma)


def _seconds_or_numbers(cells: Sequence[str], where: str, comma: bool) -> Array:
    stamps = stamps_in_texts([c.replace(",", ".") for c in cells] if comma else cells)
    return _numbers(cells, where, comma) if stamps is None else stamps


def _numbers(cells: Sequence[str], where: str, comma: bool, before: int = 0) -> Array:
    """Cells as numbers, NaN for a cell without a reading; before: number of rows read earlier."""
    out = np.full(len(cells), np.nan)
    for k, cell in enumerate(cells, start=before + 1):
        number = number_of(cell, comma=comma) if cell else math.nan
        if isinstance(number, str):
            expected = "a number"
            if comma and _NUMBER.match(cell.strip()):
                expected += " with a decimal comma, for that of other cells is one: is the point a "
                expected += "decimal sign, or does it part thousands? Write it without"
            raise ExperimentError(f"{where}, row {k}: found {quote(cell)}, expected {expected}")
        out[k - before - 1] = number
    return out

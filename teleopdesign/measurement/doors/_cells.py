"""Cells of a text table as numbers: plain numbers, and dates and times of day as text.

Dates are those of ISO with or without a zone, day or month first, AM and PM.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..encoder import Array

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
_ZONE = re.compile(r"\s*(?:(Z|UTC|GMT)|([-+])(\d{2}):?(\d{2})?)$")
#: a time of day; before it, a duration may have days
_CLOCK = re.compile(
    r"(?:(\d{1,6}) days? \+?)?(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d+)?))?"
    r"(?:\s*([AaPp])\.?[Mm]\.?)?$"
)
_YEAR_FIRST = re.compile(r"(\d{4})[-/.](\d{1,2})[-/.](\d{1,2})$")
_YEAR_LAST = re.compile(r"(\d{1,2})([-/.])(\d{1,2})\2(\d{4})$")
_MONTH_NAMED = re.compile(r"(\d{1,2})[- ]([A-Za-z]{3})[a-z]*[- ](\d{4})$")
_MONTHS = "jan feb mar apr may jun jul aug sep oct nov dec".split()
#: between a date and its time of day: ISO's T, spaces, a comma
_BETWEEN = re.compile(r"(?<=\d)(?:T|,?\s+)(?=\d{1,2}:)")


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


def stamps_of(cells: Sequence[str]) -> Array | None:
    """Times of day in s from midnight, or dates in s from the first day; None: a cell is neither.

    Cells with a time zone count in universal time, so that an hour that occurs twice in autumn
    counts as two hours.
    """
    if _CLOCK.match(cells[0].strip()):
        seconds = [_seconds_of_day(cell.strip()) for cell in cells]
        return None if None in seconds else np.array(seconds, dtype=np.float64)
    parts = [_parts_of(cell.strip()) for cell in cells]
    days = [part[0] for part in parts if part is not None]
    if len(days) < len(cells):
        return None
    dates = _dates_of(days)
    if dates is None:
        return None
    seconds = [part[1] for part in parts if part is not None]
    since = (dates - dates[0]) / np.timedelta64(1, "D") * 86_400.0
    return np.asarray(since + np.array(seconds, dtype=np.float64))


def _parts_of(cell: str) -> tuple[str, float] | None:
    """Date of a cell, and seconds from its midnight in universal time; None: no time of day."""
    between = _BETWEEN.search(cell)
    if between is None:
        return cell, 0.0
    day, clock = cell[: between.start()], cell[between.end() :]
    zone = _ZONE.search(clock)
    ahead = 0.0
    if zone is not None:
        clock = clock[: zone.start()]
        if zone[2]:
            ahead = 3600.0 * int(zone[3]) + 60.0 * int(zone[4] or 0)
            ahead = -ahead if zone[2] == "-" else ahead
    seconds = _seconds_of_day(clock)
    return None if seconds is None else (day, seconds - ahead)


def _seconds_of_day(text: str) -> float | None:
    """A time of day in s; None: the text is no time of day."""
    match = _CLOCK.match(text)
    if match is None:
        return None
    hour, minute = 24 * int(match[1] or 0) + int(match[2]), int(match[3])
    if match[5]:
        hour = hour % 12 + 12 * (match[5] in "Pp")
    return 3600.0 * hour + 60.0 * minute + float((match[4] or "0").replace(",", "."))


def _dates_of(days: Sequence[str]) -> NDArray[np.datetime64] | None:
    """Days as dates, with the day or the month first; None: some texts are no dates."""
    kinds = {day: _numbers_of(day) for day in dict.fromkeys(days)}
    if any(numbers is None for numbers in kinds.values()):
        return None
    best: tuple[int, dict[str, np.datetime64]] | None = None
    for month_first in (False, True):
        try:
            with warnings.catch_warnings(action="ignore", category=UserWarning):
                dates = {
                    day: _date(numbers, month_first) for day, numbers in kinds.items() if numbers
                }
        except ValueError:
            continue
        # "11/12/2026" is ambiguous: the reading with the fewest days is taken
        reach = int((max(dates.values()) - min(dates.values())) / np.timedelta64(1, "D"))
        if best is None or reach < best[0]:
            best = reach, dates
    return None if best is None else np.array([best[1][day] for day in days])


def _numbers_of(day: str) -> tuple[int, int, int, bool] | None:
    """Year, two other numbers, and whether slashes separate them: then either is the month."""
    if (match := _YEAR_FIRST.match(day)) is not None:
        return int(match[1]), int(match[3]), int(match[2]), False
    if (match := _MONTH_NAMED.match(day)) is not None:
        month = match[2].lower()
        return (
            (int(match[3]), int(match[1]), _MONTHS.index(month) + 1, False)
            if (month in _MONTHS)
            else None
        )
    if (match := _YEAR_LAST.match(day)) is not None:
        return int(match[4]), int(match[1]), int(match[3]), match[2] == "/"
    return None


def _date(numbers: tuple[int, int, int, bool], month_first: bool) -> np.datetime64:
    year, day, month, either = numbers
    if month_first and either:
        day, month = month, day
    return np.datetime64(f"{year:04d}-{month:02d}-{day:02d}", "D")

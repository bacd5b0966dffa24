"""Cells of a table as numbers: plain numbers, dates and times of day, also as texts.

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

from ...base.errors import ExperimentError, quote
from ..encoder import MOST_BITS, Array

#: whole numbers above are stamps in nanoseconds: 2^53, beyond which float64 skips some
_LONG = 2**MOST_BITS
#: cells that tell whether a column holds dates
_SOME = 100

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
#: days: with the year first, with the name of the month, with the year last
_DAYS = (
    re.compile(r"(?P<y>\d{4})[-/.](?P<m>\d{1,2})[-/.](?P<d>\d{1,2})(?P<sign>)$"),
    re.compile(r"(?P<d>\d{1,2})[- ](?P<m>[A-Za-z]{3})[a-z]*[- ](?P<y>\d{4})(?P<sign>)$"),
    re.compile(r"(?P<d>\d{1,2})(?P<sign>[-/.])(?P<m>\d{1,2})(?P=sign)(?P<y>\d{4})$"),
)
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
    known = ((k, cell) for k, cell in enumerate(cells) if cell is not None and cell == cell)
    filled = [k for k, cell in known if not is_empty(str(cell))]
    texts = [cell for k in filled if isinstance(cell := cells[k], str)]
    if not texts or len(texts) < len(filled) or seconds_of(texts[0]) is None:
        return None
    stamps = stamps_of(texts)
    if stamps is None:
        return None
    out = np.full(len(cells), np.nan)
    out[filled] = stamps
    return out


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
    best: tuple[int, dict[str, np.datetime64]] | None = None
    for month_first in (False, True):
        try:
            with warnings.catch_warnings(action="ignore", category=UserWarning):
                dates = {day: _date(day, month_first) for day in dict.fromkeys(days)}
        except ValueError:
            continue
        # "11/12/2026" is ambiguous: the reading with the fewest days is taken
        reach = int((max(dates.values()) - min(dates.values())) / np.timedelta64(1, "D"))
        if best is None or reach < best[0]:
            best = reach, dates
    return None if best is None else np.array([best[1][day] for day in days])


def _date(day: str, month_first: bool) -> np.datetime64:
    """A day as a date; of two numbers between slashes, either may be the month.

    raises ValueError: the text is no date
    """
    match = next(filter(None, (kind.match(day) for kind in _DAYS)), None)
    if match is None:
        raise ValueError(day)
    first, month, year = match["d"], match["m"], int(match["y"])
    if month_first and match["sign"] == "/":
        first, month = month, first
    number = int(month) if month.isdigit() else _MONTHS.index(month.lower()) + 1
    return np.datetime64(f"{year:04d}-{number:02d}-{int(first):02d}", "D")


def numbers_of(values: Any, column: str, file: str, channel: str = "") -> Array:
    """A column as float64 (n,), from numbers or dates of shape (n,), (n, 1) or (1, n).

    raises ExperimentError: more than one column, or a cell that is no number
    """
    values = np.asarray(values)
    begin = f"{file}: {channel}: column {quote(column)}" if channel else f"{file}: {quote(column)}"
    if values.ndim == 2 and 1 in values.shape:
        values = values.reshape(-1)
    if values.ndim != 1:
        raise ExperimentError(
            f"{begin}: found an array of shape {values.shape}, expected one column"
        )
    if values.dtype.kind in "mM":
        return _seconds(values)
    if values.dtype.kind in "iu" and len(values) and np.abs(values[0]) > _LONG:
        # as signed: of unsigned numbers, one below the first leaves a number near 2^64
        return np.asarray((values - values[0]).astype(np.int64), dtype=np.float64)
    if values.dtype.kind in "OU":
        values = _plain_objects(values.astype(object))
    if values.dtype.kind not in "fiub":
        row, text = _first_non_number(values)
        raise ExperimentError(f"{begin}, row {row}: found {text}, expected a number")
    numbers: Array = values.astype(np.float64)
    return numbers


def holds_dates(values: Any) -> bool:
    """Whether cells are dates, times of day or durations, also as texts: `numbers_of` gives s."""
    values = np.asarray(values)
    if values.dtype.kind in "mM":
        return True
    some = values.reshape(-1)[:_SOME].tolist() if values.dtype.kind in "OU" else []
    return bool(some) and stamps_in_texts(some) is not None


def _seconds(values: NDArray[Any]) -> Array:
    """Dates and durations in s from the first one; NaN in empty cells."""
    empty = np.isnat(values)
    filled = values[~empty]
    out = np.full(len(values), np.nan)
    if len(filled):
        out[~empty] = (filled - filled[0]) / np.timedelta64(1, "ns") * 1e-9
    return out


def _plain_objects(values: NDArray[Any]) -> NDArray[Any]:
    """Objects as numbers if all are numbers, texts of numbers or dates; None is an empty cell."""
    if any(isinstance(v, str) for v in values):
        stamps = stamps_in_texts(values.tolist())
        if stamps is not None:
            return stamps
        values = np.array([number_of(v) if isinstance(v, str) else v for v in values], dtype=object)
    if all(v is None or isinstance(v, int | float | np.number) for v in values):
        return np.array([np.nan if v is None else v for v in values], dtype=np.float64)
    if any(hasattr(v, "isoformat") for v in values):
        try:
            return _seconds(values.astype("datetime64[ns]"))
        except (TypeError, ValueError):
            return values
    return values


def _first_non_number(values: NDArray[Any]) -> tuple[int, str]:
    for row, value in enumerate(values, start=1):
        if not isinstance(value, int | float | np.number):
            return row, quote(str(value))
    return 1, f"values of type {values.dtype}"

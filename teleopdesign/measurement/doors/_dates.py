"""Dates and times of day as text: ISO with or without a zone, day or month first, AM and PM."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ._log import Array

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

"""Dates and times of day as seconds."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from ._log import Array

_DAY = re.compile(r"(\d{1,2})\.(\d{1,2})\.(\d{4})[ T](.*)$")
_ZONE = re.compile(r"(Z|[-+]\d{2}:?\d{2})$")
_TIME_OF_DAY = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d+)?)$")


def seconds_of(cell: str) -> float | None:
    """A date or a time of day as seconds; None: it is neither."""
    if ":" not in cell and "T" not in cell and cell.count("-") < 2:
        return None
    stamp = stamps_of([cell])
    return None if stamp is None else float(stamp[0])


def stamps_of(cells: Sequence[str]) -> Array | None:
    """Dates or times of day as seconds, from midnight or the first day; None: some are neither."""
    day = _TIME_OF_DAY.match(cells[0])
    try:
        if day is not None:
            parts = [c.replace(",", ".").split(":") for c in cells]
            return np.array([3600.0 * int(h) + 60.0 * int(m) + float(s) for h, m, s in parts])
        written = [_ZONE.sub("", _turned(c)).replace(",", ".") for c in cells]
        stamps = np.array(written, dtype="datetime64[ns]")
    except (ValueError, IndexError):
        return None
    if np.isnat(stamps).any():
        return None
    seconds: Array = (stamps - stamps[0].astype("datetime64[D]")).astype(np.int64) * 1e-9
    return seconds


def _turned(cell: str) -> str:
    """A date that begins with the day, as one that begins with the year."""
    match = _DAY.match(cell)
    if match is None:
        return cell.replace(" ", "T", 1)
    day, month, year, rest = match.groups()
    return f"{year}-{int(month):02d}-{int(day):02d}T{rest}"

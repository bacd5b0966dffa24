"""Workbooks (.xlsx): the first sheet with a table; others with one are said to be left out."""

from __future__ import annotations

import datetime
import math
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import ExperimentError
from ..encoder import is_most
from ._header import names_and_units
from ._log import MOST_BYTES, Log, join_names, number_names, optional, refuse_damage, refuse_size
from .shapes._table import MOST_ROWS


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
        sheets = [(s.title, list(s.iter_rows(values_only=True))) for s in book.worksheets]
        book.close()
    firsts = {title: _first_row(rows) for title, rows in sheets}
    tables = {t: (rows, first) for t, rows in sheets if (first := firsts[t]) is not None}
    if not tables:
        raise ExperimentError(f"{file}: found no sheet with a table of numbers below its header")
    title, *others = tables
    notes = [f"sheet {title!r}"] if len(sheets) > 1 else []
    if others:
        sheet = "sheet" if len(others) == 1 else "sheets"
        others = [repr(other) for other in others]
        notes.append(f"{sheet} {join_names(others, 4)}: left out; save each as a file of its own")
    refuse_size(len(tables[title][0]), file)
    return _log(*tables[title], tuple(notes))


def _first_row(rows: Sequence[Sequence[Any]]) -> int | None:
    """The first row of numbers of a sheet; None: it holds no table."""
    return next((k for k, row in enumerate(rows[:MOST_ROWS]) if _is_data(row)), None)


def _is_data(row: Sequence[Any]) -> bool:
    filled = [c for c in row if c is not None]
    kinds = int | float | datetime.datetime | datetime.time | datetime.timedelta
    return len(filled) > 1 and is_most(np.array([isinstance(c, kinds) for c in filled]))


def _log(rows: Sequence[Sequence[Any]], first: int, notes: tuple[str, ...]) -> Log:
    width = max(len(row) for row in rows[first : first + MOST_ROWS])
    above = [
        [_text(c) for c in (*row, *[None] * (width - len(row)))]
        for row in rows[:first]
        if any(c is not None for c in row)
    ]
    header, units = names_and_units(above)
    names = number_names(
        [header[k] if k < len(header) and header[k] else f"column {k + 1}" for k in range(width)]
    )
    data = rows[first:]

    def cells_of(k: int) -> list[Any]:
        return [row[k] if k < len(row) else None for row in data]

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        return {n: _column(cells_of(names.index(n))) for n in wanted}

    unit_of = {n: u for n, u in zip(names, units, strict=False) if u}
    kinds = datetime.datetime | datetime.time | datetime.timedelta
    begins = (_first_filled(cells_of(k)) for k in range(width))
    unit_of |= {n: "s" for n, c in zip(names, begins, strict=True) if isinstance(c, kinds)}
    remarks = tuple(" ".join(filter(None, row)) for row in above)
    sample = {n: _column(cells_of(k)[:MOST_ROWS]) for k, n in enumerate(names)}
    return Log(names, read, unit_of, notes, remarks=remarks, sample=sample)


def _text(cell: Any) -> str:
    return "" if cell is None else str(cell).strip()


def _seconds(cell: Any) -> float:
    """A time of day or a duration in s; NaN for an empty cell."""
    if isinstance(cell, datetime.timedelta):
        return cell.total_seconds()
    if isinstance(cell, datetime.time):
        return 3600.0 * cell.hour + 60.0 * cell.minute + cell.second + 1e-6 * cell.microsecond
    return math.nan


def _first_filled(cells: Sequence[Any]) -> Any:
    """The first cell with a content; None: all are empty."""
    return next((c for c in cells if c is not None), None)


def _column(cells: Sequence[Any]) -> Any:
    begin = _first_filled(cells)
    filled = [c for c in cells if c is not None]
    if begin is not None and all(isinstance(c, datetime.datetime) for c in filled):
        return np.array(cells, dtype="datetime64[ns]")
    if isinstance(begin, datetime.time | datetime.timedelta):
        return np.array([_seconds(c) for c in cells])
    if not all(isinstance(c, int | float) for c in filled):
        return np.array(cells, dtype=object)  # its reader names the cell that is no number
    return np.array([np.nan if c is None else c for c in cells], dtype=float)

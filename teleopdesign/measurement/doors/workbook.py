"""Workbooks (.xlsx): the first sheet with a table, its header and, if there is one, a row of
units.
"""

from __future__ import annotations

import datetime
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ExperimentError
from ._dialect import is_unit_cell
from ._log import MOST_BYTES, Log, number_names, optional, refuse_size, refusing_damage

#: rows above the first row of numbers that may be titles, names and units
_TOP = 50


def open_workbook(path: Path, file: str) -> Log:
    """A workbook; raises ExperimentError: none, too large unpacked, no row of numbers."""
    openpyxl = optional("openpyxl", file)
    with refusing_damage("workbook", file):
        with zipfile.ZipFile(path) as packed:
            size = sum(entry.file_size for entry in packed.infolist())
        if size > MOST_BYTES // 4:
            raise ExperimentError(
                f"{file}: found {size:.3g} bytes unpacked, expected a smaller table"
            )
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        sheets = [(s.title, list(s.iter_rows(values_only=True))) for s in book.worksheets]
        book.close()
    for title, rows in sheets:
        first = next((k for k, row in enumerate(rows[:_TOP]) if _is_data(row)), None)
        if first is None:
            continue
        refuse_size(len(rows), file)
        notes = (f"sheet {title!r}",) if len(sheets) > 1 else ()
        return _log(rows, first, notes)
    raise ExperimentError(f"{file}: found no sheet with a table of numbers below its header")


def _is_data(row: Sequence[Any]) -> bool:
    filled = [c for c in row if c is not None]
    kinds = int | float | datetime.datetime | datetime.time
    return len(filled) > 1 and sum(isinstance(c, kinds) for c in filled) > 0.5 * len(filled)


def _log(rows: Sequence[Sequence[Any]], first: int, notes: tuple[str, ...]) -> Log:
    above = [[_text(c) for c in row] for row in rows[:first] if any(c is not None for c in row)]
    units: list[str] = []
    if len(above) > 1 and all(map(is_unit_cell, above[-1])):
        units = [c.strip("[]() ") for c in above.pop()]
    header = above[-1] if above else []
    width = max(len(row) for row in rows[first : first + _TOP])
    names = number_names(
        [header[k] if k < len(header) and header[k] else f"column {k + 1}" for k in range(width)]
    )
    data = rows[first:]

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        return {n: _column([row[names.index(n)] for row in data]) for n in wanted}

    said = {n: u for n, u in zip(names, units, strict=False) if u}
    return Log(names, read, said, notes)


def _text(cell: Any) -> str:
    return "" if cell is None else str(cell).strip()


def _column(cells: Sequence[Any]) -> Any:
    if any(isinstance(c, datetime.datetime) for c in cells[:1]):
        return np.array(cells, dtype="datetime64[ns]")
    if any(isinstance(c, str) for c in cells):
        return np.array(cells, dtype=object)
    return np.array([np.nan if c is None else c for c in cells], dtype=object).astype(float)

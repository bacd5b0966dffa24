"""Workbooks (.xlsx): the first sheet with a table; others with one are said to be left out.

The cells of a sheet become lines with tabs between them, which are read as those of a text.
"""

from __future__ import annotations

import datetime
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...base.errors import ExperimentError
from ._log import MOST_BYTES, Log, join_names, optional, refuse_damage, refuse_size
from .text import open_lines


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
        sheets = {s.title: [*map(_line, s.iter_rows(values_only=True))] for s in book.worksheets}
        book.close()
    tables: dict[str, Log] = {}
    for title, lines in sheets.items():
        refuse_size(len(lines), file)
        try:
            tables[title] = open_lines([line for line in lines if line.strip()], file)
        except ExperimentError:  # a sheet of texts, or empty
            continue
    if not tables:
        raise ExperimentError(f"{file}: found no sheet with a table of numbers below its header")
    title, *others = tables
    log = tables[title]
    notes = [f"sheet {title!r}"] if len(sheets) > 1 else []
    if others:
        sheet = "sheet" if len(others) == 1 else "sheets"
        others = [repr(other) for other in others]
        notes.append(f"{sheet} {join_names(others, 4)}: left out; save each as a file of its own")
    return replace(log, notes=(*notes, *log.notes))


def _line(row: tuple[Any, ...]) -> str:
    return "\t".join(map(_text, row))


def _text(cell: Any) -> str:
    """A cell as a text table holds it: durations as a time of day, which may have days."""
    if isinstance(cell, bool):
        return str(int(cell))
    if isinstance(cell, datetime.datetime):
        return cell.isoformat()
    if isinstance(cell, datetime.timedelta):
        minutes, seconds = divmod(cell.seconds + 1e-6 * cell.microseconds, 60)
        return f"{cell.days} days {minutes // 60:02.0f}:{minutes % 60:02.0f}:{seconds:09.6f}"
    return "" if cell is None else " ".join(str(cell).replace('"', "'").split())

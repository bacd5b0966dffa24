"""Text tables with a signal in each row, as a matrix of row vectors is written.

    0.000, 0.001, 0.002, ...              time,     0.000, 0.001, ...
    0.10,  0.11,  0.12,  ...              position, 0.10,  0.11,  ...

A recording has 64 rows or more. So a table of fewer rows, with at least 64 cells each, is turned.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ._cells import number_of
from ._dialect import COMMENTS, LOOKED_AT, cells_of, open_bytes
from ._encoding import encoding_of
from ._log import Array, Log, number_names

#: fewest rows of a recording
FEWEST = 64
#: most bytes of such a table: all of its cells are read at once
MOST_BYTES = 20_000_000


def open_signals_in_rows(path: Path, file: str) -> Log | None:
    """A text table with a signal in each row; None: any other table.

    raises ExperimentError: a row with another number of cells than the others
    """
    with open_bytes(path) as stream:
        raw = stream.read(LOOKED_AT)
        if not raw or raw.count(b"\n") + raw.count(b"\r") >= 2 * FEWEST:
            return None  # in most files nothing more is read
        raw += stream.read(MOST_BYTES)
    text = raw.decode(encoding_of(raw, file, whole=True), errors="ignore")
    lines = [s for line in text.splitlines() if (s := line.strip()) and not s.startswith(COMMENTS)]
    if not 2 <= len(lines) < FEWEST:
        return None
    for separator, comma in ((",", False), (";", True), (";", False), ("\t", False), (" ", False)):
        rows = [cells_of(line.rstrip(separator), separator) for line in lines]
        signals = _signals(rows, comma) if min(map(len, rows)) >= FEWEST else None
        if signals is not None:
            return _log_of(signals)
    return None


def _signals(rows: list[list[str]], comma: bool) -> dict[str, Array] | None:
    """The numbers of each row by name; None: the rows are not all numbers of the same count."""
    if len(set(map(len, rows))) != 1:
        return None
    named = all(isinstance(number_of(row[0], comma=comma), str) for row in rows)
    names = [row[0] if named else f"column {k + 1}" for k, row in enumerate(rows)]
    values = [[number_of(cell, comma=comma) for cell in row[named:]] for row in rows]
    if any(isinstance(value, str) for row in values for value in row):
        return None
    numbers = (np.array(row, dtype=float) for row in values)
    return dict(zip(number_names(names), numbers, strict=True))


def _log_of(signals: Mapping[str, Array]) -> Log:
    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        return {name: signals[name] for name in wanted}

    return Log(tuple(signals), read, notes=("a signal in each row: read as columns",))

"""Traces of controllers after IEC 61131: a signal after the other, each with its times.

    0.Variable; Axis.ActPosition
    0.Data;
    ; 2; 0.10
    ; 22; 0.11
    1.Variable; Axis.ActTorque
    1.Data;
    ; 2; 1.5

Such rows are read as pairs of columns: the time of a signal, and the signal.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import ExperimentError, quote
from ._cells import is_number, number_of
from ._clock_before_signal import with_clocks_before
from ._lines_of_file import open_lines
from ._log import Array, Log, number_names, refuse_size

#: a line that names a signal, and one after which its rows begin
_NAME = re.compile(r"\d++\.Variable\s*+;(.*)$")
_DATA = re.compile(r"\d++\.Data\s*+;\s*+$")
#: readings of a switch
SWITCH = {"TRUE": 1.0, "FALSE": 0.0}


def has_signals_in_turn(lines: Sequence[str]) -> bool:
    """Whether the first lines of a file are those of such a trace."""
    named = (k for k, line in enumerate(lines) if _NAME.match(line))
    first = next(named, None)
    return first is not None and any(map(_DATA.match, lines[first:]))


def log_of_signals_in_turn(path: Path, file: str, encoding: str) -> Log:
    """The log of such a trace; raises ExperimentError: a row of text, or no row."""
    with open_lines(path, encoding, errors="replace") as stream:
        signals = [*_signals(stream, file)]
    return log_of_signals(signals, file, "a trace with a signal after the other")


def log_of_signals(
    signals: Iterable[tuple[str, Sequence[tuple[float, float]]]],
    file: str,
    note: str,
    units: Mapping[str, str] | None = None,
    time_unit: str | None = None,
) -> Log:
    """The log of signals with times of their own.

    signals: name, and rows of a time and a reading;  units: signal -> unit;  note: on the file
    raises ExperimentError: no signal has rows
    """
    signals = [(name, rows) for name, rows in signals if rows]
    if not signals:
        raise ExperimentError(f"{file}: found signals without rows, expected at least 64 rows")
    names = number_names([name for name, _ in signals])
    clock_of = {name: f"time of {name}" for name in names}
    columns: dict[str, Array] = {}
    longest = max(len(rows) for _, rows in signals)
    for name, (_, rows) in zip(names, signals, strict=True):
        table = np.full((longest, 2), np.nan)
        table[: len(rows)] = rows
        columns[clock_of[name]], columns[name] = table.T

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        return {name: columns[name] for name in wanted}

    stated = dict(units or {}) | (dict.fromkeys(clock_of.values(), time_unit) if time_unit else {})
    return with_clocks_before(Log((*columns,), read, stated, (note,)), file, clock_of)


def _signals(stream: Iterable[str], file: str) -> Iterator[tuple[str, list[tuple[float, float]]]]:
    """The name of each signal with its times and readings."""
    name, rows, here = "", list[tuple[float, float]](), False
    for number, line in enumerate(stream, 1):
        if (match := _NAME.match(line.rstrip())) is not None:
            if rows:
                yield name, rows
            name, rows, here = match[1].strip(), [], False
        elif _DATA.match(line.rstrip()):
            here = True
        elif here and line.strip():
            rows.append(_row(line, number, file))
            refuse_size(len(rows), file)
    if rows:
        yield name, rows


def _row(line: str, number: int, file: str) -> tuple[float, float]:
    """A time and a reading; a switch is 0 or 1, and any other text is no reading (NaN)."""
    cells = [cell.strip() for cell in line.split(";") if cell.strip()]
    comma = any("," in cell for cell in cells)
    if len(cells) != 2 or not is_number(cells[0], comma):
        raise ExperimentError(
            f"{file}: line {number}: found {quote(line.strip())}, expected a time and a reading"
        )
    value = SWITCH.get(cells[1].upper(), number_of(cells[1], comma=comma))
    return float(number_of(cells[0], comma=comma)), np.nan if isinstance(value, str) else value

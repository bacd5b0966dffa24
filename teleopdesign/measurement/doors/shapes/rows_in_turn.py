"""Tables whose rows belong to several machines or signals in turn, which a column names.

Viewers of bags, data bases and decoders of a bus write one reading in each row.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...column_names import words_of
from ...encoder import Array, is_most
from ...limits import HALF
from .._header import UNIT_LABELS, bare_unit
from .._log import MOST_PARTS, MOST_SIGNALS, join_names
from ._table import FEWEST_ROWS, CellTable, LongSignal, LongTable, as_text, time_of

#: last words of the names of the columns that name the signal of a row, and that hold its reading
SIGNALS = frozenset("topic signal channel variable tag parameter series measurement".split())
READINGS = frozenset("value values reading wert valeur valor".split())

#: words of the name of a column that names or numbers machines
NUMBERS_MACHINES = frozenset(
    "id ids no nr num number name motor joint servo axis actuator node device drive can leg".split()
)


def machines_in_turn(table: CellTable) -> LongTable | None:
    """Rows of several machines in turn, named in a column: "hip, 0.0, 0.1", "knee, 0.0, 2.3".

    Trials follow each other, machines run together. The state of one machine lasts for some rows,
    or changes without a leap of its signals.
    """
    time = time_of(table)
    if not time or len(table.columns[time]) < 2 * FEWEST_ROWS:
        return None
    for name in (n for n in table.names if n != time):
        labels = _labels_of(name, table.columns[name])
        numbers = [x for n, x in table.numeric.items() if n not in (time, name)]
        if labels and _run_together(labels[1], table.numeric[time], numbers):
            return _apart(table, time, name, labels)
    return None


def _labels_of(name: str, column: NDArray[Any]) -> tuple[list[str], NDArray[np.intp]] | None:
    """The names of machines and the number of each row's machine, where a column may hold them."""
    numbered = column.dtype.kind == "f"
    words = words_of(name)
    if numbered and not (words and NUMBERS_MACHINES.issuperset(words)):
        return None
    if numbered and not (np.all(column == np.round(column)) and np.all(column >= 0)):
        return None
    number = {cell: k for k, cell in enumerate(dict.fromkeys(column.tolist()))}
    if not 2 <= len(number) <= MOST_PARTS or not {"", None}.isdisjoint(number):
        return None
    return [as_text(c) for c in number], np.array([number[c] for c in column], dtype=np.intp)


def _run_together(labels: NDArray[np.intp], stamps: Array, signals: Sequence[NDArray[Any]]) -> bool:
    """Whether the machines of some rows run at the same time, each with signals of its own."""
    rows = [np.flatnonzero(labels == k) for k in range(int(labels.max()) + 1)]
    changes = np.diff(labels) != 0
    if min(map(len, rows)) < FEWEST_ROWS or int(changes.sum()) < 2 * len(rows):
        return False
    if any(np.any(np.diff(stamps[r]) < 0) for r in rows):
        return False
    if int(np.sum(np.diff(stamps)[changes] < 0)) >= len(rows):
        return True
    in_turn = float(changes.mean()) >= HALF
    return in_turn and any(_leaps_between(signal, rows) for signal in signals)


def _leaps_between(signal: Array, rows: Sequence[NDArray[np.intp]]) -> bool:
    """Whether a signal changes less within the rows of each machine than from row to row."""
    if not np.all(np.isfinite(signal)):
        return False
    within = sum(float(np.abs(np.diff(signal[r])).sum()) for r in rows)
    return within < HALF * float(np.abs(np.diff(signal)).sum())


def _apart(
    table: CellTable, time: str, key: str, labels: tuple[list[str], NDArray[np.intp]]
) -> LongTable:
    """The signals of each machine, with its own clock: "hip.position" at "hip.time"."""
    names, machine = labels
    signals = []
    for k, name in enumerate(names):
        rows = machine == k
        clock, times = f"{name}.{time}", table.numeric[time][rows]
        for n in (n for n in table.names if n not in (time, key)):
            unit, time_unit = table.units.get(n, ""), table.unit_of_time(time)
            values = table.columns[n][rows]
            signals.append(LongSignal(f"{name}.{n}", values, clock, times, unit, time_unit))
    note = f"rows of {len(names)} machines in turn, named in {key!r}: {join_names(names, most=4)}"
    return LongTable(tuple(signals), len(machine), note)


def reading_in_each_row(table: CellTable) -> LongTable | None:
    """A column that names the signal, one with its reading: "0.0, angle, 0.1", "0.0, torque, 1"."""
    time = time_of(table)
    ends = {n: (words_of(n) or [""])[-1] for n in table.names}
    keys = [n for n, word in ends.items() if word in SIGNALS]
    readings = [n for n, word in ends.items() if word in READINGS]
    if not time or len(keys) != 1 or len(readings) != 1:
        return None
    cells = table.columns[readings[0]]
    numbers = np.array([np.nan if isinstance(cell, str) else cell for cell in cells], dtype=float)
    texts = table.columns[keys[0]]
    numbered = table.columns[keys[0]].dtype.kind == "f"
    fine = np.isfinite(numbers) & np.isfinite(table.numeric[time])
    names = list(dict.fromkeys(texts[fine].tolist()))
    number = {name: k for k, name in enumerate(names)}
    of_row = np.array([number.get(text, -1) for text in texts])
    if numbered or not 0 < len(names) <= MOST_SIGNALS or not is_most(fine):
        return None
    unit = next((n for n in table.names if n.casefold() in UNIT_LABELS), "")
    signals = []
    for name in names:
        rows = np.flatnonzero(fine & (of_row == number[name]))
        stated = bare_unit(str(table.columns[unit][rows[0]])) if unit else ""
        times = table.numeric[time][rows]
        clock, time_unit = f"time of {name}", table.unit_of_time(time)
        signals.append(LongSignal(name, numbers[rows], clock, times, stated, time_unit))
    return LongTable(tuple(signals), int(fine.sum()), "a reading in each row")

"""Tables whose rows belong to several machines in turn: each of them is read with its own clock.

motor_id; t;     pos;  cmd           joint, time, position, effort
1;        0.000; 0.10; 0.2           hip,   0.00, 0.10,     1.5
2;        0.001; 2.30; 0.0           knee,  0.00, 2.30,     0.1
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...column_names import words_of
from ...encoder import Array
from ...limits import HALF
from .._log import MOST_PARTS, join_names
from ._table import FEWEST_ROWS, CellTable, LongSignal, LongTable, as_text, time_of

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

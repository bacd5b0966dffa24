"""Tables with one reading in each row, and a column that names its signal.

    elapsed time, receive time, topic, value        time, signal, value, unit
    0.000, ..., /joint_states.position[0], 0.10     0.000, angle,  0.10, rad
    0.000, ..., /command.data, 1.5                  0.000, torque, 1.50, Nm

Viewers of bags, data bases and decoders of a bus write such tables.
"""

from __future__ import annotations

import numpy as np

from ...column_names import words_of
from ...encoder import is_most
from .._header import UNIT_LABELS, bare_unit
from .._log import MOST_SIGNALS
from ._table import CellTable, LongSignal, LongTable, time_of

#: last words of the names of the columns that name the signal of a row, and that hold its reading
SIGNALS = frozenset("topic signal channel variable tag parameter series measurement".split())
READINGS = frozenset("value values reading wert valeur valor".split())


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

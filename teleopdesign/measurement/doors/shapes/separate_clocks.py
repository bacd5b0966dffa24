"""Tables in which each signal has numbers only at its own times, as viewers export topics.

__time, /joint/position, /command
0.000,  0.10,
0.002,           , 1.5
0.010,  0.11,
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...column_names import likeness
from ...encoder import is_most
from ._table import CellTable, LongSignal, LongTable


def separate_clocks(table: CellTable) -> LongTable | None:
    """Signals with numbers only at their own times, as viewers export topics: "0.1, , 1.5"."""
    filled = {n: _is_filled(x) for n, x in table.columns.items()}
    share = {n: float(mask.mean()) if len(mask) else 0.0 for n, mask in filled.items()}
    full = [n for n, part in share.items() if part == 1.0]
    if len(full) != 1 or likeness(full[0], "time") == 0.0 or full[0] not in table.numeric:
        return None  # beside a signal with numbers in all rows, another one has lost them
    partial = {n: mask for n, mask in filled.items() if 0.0 < share[n] < 1.0}
    masks = [*partial.values()]
    # a channel that loses more readings than it keeps could not be used on the clock of others
    if not any(is_most(~mask) for mask in masks) and not _never_share_a_row(masks):
        return None
    time, groups = full[0], dict[bytes, str]()
    signals = []
    for name, mask in partial.items():
        first = groups.setdefault(mask.tobytes(), name)
        clock, times = f"{time} of {first}", table.numeric[time][mask]
        unit, time_unit = table.units.get(name, ""), table.unit_of_time(time)
        signals.append(LongSignal(name, table.columns[name][mask], clock, times, unit, time_unit))
    return LongTable(tuple(signals))


def _is_filled(column: NDArray[Any]) -> NDArray[np.bool_]:
    if column.dtype.kind == "f":
        return np.asarray(np.isfinite(column))
    return np.array([bool(cell) for cell in column], dtype=bool)


def _never_share_a_row(filled: Sequence[NDArray[np.bool_]]) -> bool:
    """Whether two columns have no row in common: two topics at one rate fill half of the rows each.

    Columns of one clock that lost some readings have most of the others in common.
    """
    masks = np.array([*{mask.tobytes(): mask for mask in filled}.values()], dtype=np.float32)
    return len(masks) > 1 and bool(np.any(masks @ masks.T == 0.0))

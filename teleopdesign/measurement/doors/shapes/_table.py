"""Tables of cells, and long tables: what a shape makes of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...column_names import likeness
from ...encoder import Array
from ...stamps import unit_of_time

#: rows of a table by which its shape is judged: batches of up to 200 rows of two machines come back
MOST_ROWS = 1000
#: fewest rows of each signal among the rows that are judged
FEWEST_ROWS = 10
#: part of its usual step by which steps of a clock without a name of one may differ: the
#: coordinates of a body that is seen by a camera also rise for a while, but not so evenly; a
#: machine that speeds up or turns back differs by more, and so does a ripple of its speed
AS_EVEN_AS_A_CLOCK = 0.02


@dataclass(frozen=True)
class CellTable:
    """Rows of cells.

    columns: name -> numbers (n,), NaN where a cell is empty, or cells (n,) of which some are texts
    units: column -> unit, where the file states one;  dated: columns of dates
    """

    columns: Mapping[str, NDArray[Any]]
    units: Mapping[str, str] = field(default_factory=dict)
    dated: frozenset[str] = frozenset()

    @property
    def names(self) -> list[str]:
        return list(self.columns)

    @property
    def numeric(self) -> dict[str, Array]:
        return {n: x for n, x in self.columns.items() if x.dtype.kind == "f"}

    def unit_of_time(self, column: str) -> str | None:
        return unit_of_time(column, "s" if column in self.dated else self.units.get(column))

    def signal(self, name: str, rows: Any, time: str, clock: str, called: str = "") -> LongSignal:
        """Some rows of a column as a signal, with its times in another column.

        rows: mask or indices;  clock: name of its times;  called: name of the signal; "": as before
        """
        values, times = self.columns[name][rows], self.numeric[time][rows]
        unit, time_unit = self.units.get(name, ""), self.unit_of_time(time)
        return LongSignal(called or name, values, clock, times, unit, time_unit)


@dataclass(frozen=True)
class LongSignal:
    """One signal of a long table.

    name: of the signal;  values, times: (n,);  unit: "" without one
    clock: name of its times, "" without times;  time_unit: None where the file states none
    """

    name: str
    values: NDArray[Any]
    clock: str = ""
    times: Array | None = None
    unit: str = ""
    time_unit: str | None = None


@dataclass(frozen=True)
class LongTable:
    """All signals of a table.

    labels: cells that only tell to which signal a row belongs;  note: on the shape, "" for columns
    """

    signals: tuple[LongSignal, ...]
    labels: int = 0
    note: str = ""


def time_of(table: CellTable) -> str:
    """The column that is called time; "" without one."""
    numeric = table.numeric
    best = max(numeric, key=lambda n: likeness(n, "time"), default="")
    return best if best and likeness(best, "time") > 0.0 else ""


def rises(column: Array) -> bool:
    """Whether all numbers of a column are larger than those before, up to empty rows at its end."""
    filled = np.isfinite(column)
    count = int(filled.sum())
    return count > 2 and bool(filled[:count].all() and np.all(np.diff(column[:count]) > 0))


def as_text(cell: Any) -> Any:
    """A cell as a text table holds it: 2.0 of a column of numbers is "2"."""
    if isinstance(cell, float | np.floating):
        return str(int(cell)) if float(cell).is_integer() else "" if np.isnan(cell) else str(cell)
    return "" if cell is None else str(cell)

"""Tables of which each column is a signal."""

from __future__ import annotations

from ._table import LongTable, Signal, Table, rises, time_of


def columns(table: Table) -> LongTable | None:
    """Each column is a signal; they share the time, if there is one."""
    time = time_of(table) or next((n for n, x in table.numeric.items() if rises(x)), "")
    times = table.numeric.get(time)
    others = (n for n in table.names if n != time)
    return LongTable(tuple(Signal(n, table.columns[n], time, times) for n in others))

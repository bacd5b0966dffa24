"""Tables with a time before each signal, or before each group of signals at one rate.

    Position, , Torque,                   time, Force, time, Position
    X, Y, X, Y                            0.000, 0.13, 0.000, -3.21
    0, 1796, 0, 12                        0.001, 0.13, 0.002, -3.22

Studios of drives, scopes of controllers and simulators write traces in this way.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Mapping

import numpy as np

from ....base.units import measures
from ...column_names import likeness, unit_of_text
from ...usual_step import step_deviations
from .._log import bare_column, join_names
from ._table import AS_EVEN_AS_A_CLOCK, CellTable, LongSignal, LongTable, rises


def clock_before_signals(table: CellTable) -> LongTable | None:
    """A time before each signal or group of signals: "time, Force, time, Position"."""
    clock_of = _clocks_before(table)
    short, single, signals = _short_names(clock_of), list[str](), list[LongSignal]()
    for name, clock in clock_of.items():
        rows = np.isfinite(table.numeric[clock])
        if int(rows.sum()) < 2:  # a trace may hold a constant in one row
            single.append(short[name])
            continue
        times, values = table.numeric[clock][rows], table.columns[name][rows]
        unit, time_unit = table.units.get(name, ""), table.unit_of_time(clock)
        new = short[name]
        signals.append(LongSignal(new, values, f"time of {new}", times, unit, time_unit))
    if not signals:
        return None
    left = f"signals of one row, left out: {join_names(single, most=4)}" if single else ""
    return LongTable(tuple(signals), note=left)


def _clocks_before(table: CellTable) -> dict[str, str]:
    """Signal -> clock in the nearest such column before it; empty: any other table."""
    names, numeric = table.names, table.numeric
    word = bare_column(names[0]) if names else ""
    clocks = [name for name in names if bare_column(name) == word]
    if len(clocks) < 2 and len(names) % 2 == 0:  # below titles: "Position X, Position Y"
        clocks = names[::2]
        ends = {(bare_column(name).split() or [""])[-1] for name in clocks}
        word = ends.pop() if len(ends) == 1 else ""
    others = [name for name in names if name not in clocks]
    if len(clocks) < 2 or not word or not others or not numeric.keys() >= {*clocks}:
        return {}
    rising = {name for name, x in numeric.items() if rises(x)}
    if not rising >= {*clocks} or rising >= {*others}:
        return {}
    unit = unit_of_text(word)
    timed = unit is not None and unit != "counts" and measures(unit, "time")
    alternate = names[::2] == clocks and all(
        np.all(step_deviations(x[np.isfinite(x)]) <= AS_EVEN_AS_A_CLOCK)
        for x in (numeric[clock] for clock in clocks)
    )
    if likeness(word, "time") == 0.0 and not timed and not alternate:
        return {}
    places = [names.index(clock) for clock in clocks]
    return {n: names[places[bisect(places, k) - 1]] for k, n in enumerate(names) if n in others}


def _short_names(clock_of: Mapping[str, str]) -> dict[str, str]:
    """Signal -> its title, where all signals are called by one word below titles ("Torque Y")."""
    ends = {(signal.split() or [""])[-1] for signal in clock_of}
    titles = {
        signal: clock.rpartition(" ")[0]
        for signal, clock in clock_of.items()
        if signal.rpartition(" ")[0] == clock.rpartition(" ")[0] != ""
    }
    if len(ends) == 1 and len(titles) == len(clock_of) == len({*titles.values()}):
        return titles
    return {signal: signal for signal in clock_of}

"""Tables with a time before each signal, or before each group of signals at one rate.

    Position, , Torque,                   time, Force, time, Position
    X, Y, X, Y                            0.000, 0.13, 0.000, -3.21
    0, 1796, 0, 12                        0.001, 0.13, 0.002, -3.22

Studios of drives, scopes of controllers and simulators write traces in this way. Where all times
are the same, the table has one time. Otherwise each signal has a clock of its own, as each topic of
a bag has.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...base.units import measures, si_factor
from ..wrapped_stamps import unwrap_stamps
from ._cells import number_of
from ._log import Array, Log, bare_column, join_names

#: fewest signals of such a table: one alone is a table with a time and a signal
FEWEST = 2
#: fewest stamps of a signal that changes: a trace may hold a constant in one row
FEWEST_STAMPS = 2
#: fewest rows that show whether a column is a clock
FEWEST_ROWS = 3
#: part of its usual step by which each step of a clock without a name of one may differ: the
#: coordinates of a body that is seen by a camera also rise for a while, but not so evenly
AS_EVEN_AS_A_CLOCK = 0.02
#: part of the shortest time of a signal that all signals share: else their clocks count apart
SHARED = 0.5


def clocks_before_signals(
    names: Sequence[str], rows: Iterable[Sequence[str]], comma: bool
) -> dict[str, str]:
    """Signal -> clock in the nearest such column before it; empty: any other table.

    rows: the first rows of the table, as cells;  comma: the decimal sign is a comma
    """
    width = len(names)
    word = bare_column(names[0])
    clocks = [name for name in names if bare_column(name) == word]
    if len(clocks) < FEWEST and width % 2 == 0:  # below titles: "Position X, Position Y"
        clocks = [*names[::2]]
        word = _word_of_all(clocks)
    if len(clocks) < FEWEST or not word or len(clocks) == width:
        return {}
    wide = [row for row in rows if len(row) == width]
    columns = [_numbers(cells, comma) for cells in zip(*wide, strict=True)]
    of_clocks = [x for name, x in zip(names, columns, strict=False) if name in clocks]
    others = [x for name, x in zip(names, columns, strict=False) if name not in clocks]
    if not columns or not all(map(_rises, of_clocks)) or all(map(_rises, others)):
        return {}
    if not _is_name_of_time(word) and not (
        list(names[::2]) == clocks and all(map(_is_even, of_clocks))
    ):
        return {}
    places = [names.index(clock) for clock in clocks]
    before = (names[places[bisect(places, k) - 1]] for k in range(width))
    return {name: clock for name, clock in zip(names, before, strict=True) if name != clock}


def with_clocks_before(log: Log, file: str, clock_of: Mapping[str, str]) -> Log:
    """The log with one time where all clocks are the same, else with a clock for each signal.

    clock_of: signal -> clock, for all columns of the log
    """
    from ..numbers_in_cells import numbers_of

    values = log.read(dict.fromkeys(clock_of.values(), "channels.time"))
    stamps = {clock: numbers_of(x, clock, file) for clock, x in values.items()}
    single = [name for name, clock in clock_of.items() if _count(stamps[clock]) < FEWEST_STAMPS]
    clock_of = {name: clock for name, clock in clock_of.items() if name not in single}
    stamps = {clock: stamps[clock] for clock in clock_of.values()}
    if not stamps:
        return log
    if single:
        note = f"signals of one row, left out: {join_names(single, most=4)}"
        log = replace(log, notes=(*log.notes, note))
    name_of = _short_names(clock_of)
    signals = {name_of[signal]: signal for signal in clock_of}
    first = next(iter(stamps))
    same = all(np.array_equal(x, stamps[first], equal_nan=True) for x in stamps.values())
    units = {new: log.units[old] for new, old in signals.items() if old in log.units}
    if same:
        time = "time" if "time" not in signals else first
        columns = {time: first, **signals}
        units |= {time: log.units[first]} if first in log.units else {}
        return replace(log, names=(*columns,), read=_reader_of(log, columns), units=units)
    seconds = _seconds_of(log, stamps)
    if not _run_together(seconds.values()):
        return log
    times = {f"time of {new}": clock_of[old] for new, old in signals.items()}
    rows = {clock: np.isfinite(x) for clock, x in stamps.items()}
    read_signals = _reader_of(log, signals)

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        plain = read_signals({w: channel for w, channel in wanted.items() if w in signals})
        out = {w: seconds[times[w]] if w in times else plain[w] for w in wanted}
        return {w: x[rows[times.get(w) or clock_of[signals[w]]]] for w, x in out.items()}

    return replace(
        log,
        names=tuple(name for new in signals for name in (f"time of {new}", new)),
        read=read,
        units={**units, **dict.fromkeys(times, "s")},
        notes=(*log.notes, f"signals with times of their own: {join_names(signals, most=4)}"),
        clocks={new: f"time of {new}" for new in signals},
    )


def _count(stamps: Array) -> int:
    return int(np.isfinite(stamps).sum())


def _reader_of(log: Log, columns: Mapping[str, str]) -> Any:
    """A function that reads columns of a log by other names: new name -> name in the log."""

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        values = log.read({columns[w]: channel for w, channel in wanted.items()})
        return {w: values[columns[w]] for w in wanted}

    return read


def _word_of_all(clocks: Sequence[str]) -> str:
    """The word that all names of clocks share: their name, or its end below titles; "" without."""
    bare = {bare_column(name) for name in clocks}
    if len(bare) == 1:
        return bare.pop()
    ends = {name.split()[-1] if name.split() else "" for name in clocks}
    return ends.pop() if len(ends) == 1 else ""


def _is_name_of_time(name: str) -> bool:
    from ..column_names import likeness, unit_of_text

    unit = unit_of_text(name)
    is_unit = unit is not None and unit != "counts" and measures(unit, "time")
    return likeness(name, "time") > 0.0 or is_unit


def _short_names(clock_of: Mapping[str, str]) -> dict[str, str]:
    """Signal -> its title, where all signals are called by one word below titles ("Torque Y")."""
    ends = {signal.split()[-1] if signal.split() else "" for signal in clock_of}
    titles = {
        signal: clock.rpartition(" ")[0]
        for signal, clock in clock_of.items()
        if signal.rpartition(" ")[0] == clock.rpartition(" ")[0] != ""
    }
    if len(ends) == 1 and len(titles) == len(clock_of) == len({*titles.values()}):
        return titles
    return {signal: signal for signal in clock_of}


def _seconds_of(log: Log, stamps: Mapping[str, Array]) -> dict[str, Array]:
    """The stamps of each clock in s, by the unit that the log states, or by their steps.

    One program wrote all clocks without a unit, in one unit: steps of 0.1 alone would be seconds,
    but are 0.1 ms beside steps of 1.
    """
    from ..column_names import unit_in_name
    from ..stamp_unit import unit_of_steps

    slowest = max(stamps.values(), key=lambda x: float(np.median(np.diff(x[np.isfinite(x)]))))
    usual = unit_of_steps(slowest)[0]
    out = {}
    for name, values in stamps.items():
        unit = log.units.get(name) or unit_in_name(name, "time")
        factor = si_factor(unit if unit and measures(unit, "time") else usual, quantity="time")
        out[name] = unwrap_stamps(values)[0] * factor
    return out


def _run_together(seconds: Iterable[Array]) -> bool:
    """Whether all clocks share most of their time, so that they count from the same instant."""
    finite = [x[np.isfinite(x)] for x in seconds]
    ends = [(float(x.min()), float(x.max())) for x in finite]
    shared = min(end for _, end in ends) - max(begin for begin, _ in ends)
    return shared > SHARED * min(end - begin for begin, end in ends)


def _numbers(cells: Sequence[str], comma: bool) -> Array:
    """The numbers of a column; NaN for any other text."""
    values = (number_of(cell, comma=comma) for cell in cells)
    return np.array([np.nan if isinstance(v, str) else v for v in values], dtype=np.float64)


def _rises(column: Array) -> bool:
    """Whether all numbers of a column are larger than those before, up to empty rows at its end."""
    filled = np.isfinite(column)
    count = int(filled.sum())
    if count < FEWEST_ROWS or not filled[:count].all():
        return False
    return bool(np.all(np.diff(column[:count]) > 0))


def _is_even(column: Array) -> bool:
    steps = np.diff(column[np.isfinite(column)])
    usual = float(np.median(steps))
    return bool(np.all(np.abs(steps - usual) <= AS_EVEN_AS_A_CLOCK * usual))

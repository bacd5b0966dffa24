"""Shapes of tables: how the rows of a file hold signals, each with its times.

A shape is a function from a table to a `LongTable`, and None for a table of another shape. Shapes
judge the first rows, and the best reading is taken: the one with the most numbers, the most
regular clocks and the fewest cells left over. A new shape is a function, and a line in `SHAPES`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....base.errors import ExperimentError
from ....base.units import si_factor
from ...encoder import Array
from ...limits import FEWEST, HALF
from ...record_clock import DATE
from ...stamps import share_time, step_deviations, unit_of_steps, unwrap_stamps
from .._cells import holds_dates, is_column_of_texts, numbers_of
from .._log import Log, join_names
from ._table import CellTable, LongSignal, LongTable, as_text, rises, time_of
from .several_clocks import (
    clock_before_signals,
    machines_in_turn,
    reading_in_each_row,
    separate_clocks,
    two_part_time,
)

TableShape = Callable[[CellTable], LongTable | None]


def columns(table: CellTable) -> LongTable | None:
    """Each column is a signal; they share the time, if there is one."""
    time = time_of(table) or next((n for n, x in table.numeric.items() if rises(x)), "")
    times = table.numeric.get(time)
    others = (n for n in table.names if n != time)
    return LongTable(tuple(LongSignal(n, table.columns[n], time, times) for n in others))


#: all shapes. Of equally good readings the last one counts: it says more of the table
SHAPES: tuple[TableShape, ...] = (
    columns,
    two_part_time,
    machines_in_turn,
    separate_clocks,
    clock_before_signals,
    reading_in_each_row,
)


def score(long: LongTable, table: CellTable) -> float:
    """Cells of a table that a reading makes numbers of, weighted by how regular its clocks are.

    Rows without a clock are held to be as regular as a clock with half of its steps.

    Cells of the long table that stay empty count against it, as do rows too few for a recording.
    """
    if len(next(iter(table.columns.values()), ())) < FEWEST:
        return 0.0
    numbers, empty = float(long.labels), 0
    clocks: dict[str, float] = {}
    for signal in long.signals:
        count = int(np.isfinite(signal.values).sum()) if signal.values.dtype.kind == "f" else 0
        numbers += count
        empty += len(signal.values) - count
        if signal.times is not None and signal.clock not in clocks:
            # steps that go forward, by less than twice the usual one
            off = step_deviations(signal.times[np.isfinite(signal.times)])
            clocks[signal.clock] = float(np.mean(off < 1.0)) if len(off) else 0.0
            numbers += len(signal.times)
    regular = float(np.mean([*clocks.values()])) if clocks else HALF
    return numbers * regular * numbers / max(numbers + empty, 1.0)


def best_shape(table: CellTable) -> tuple[TableShape, float]:
    """The shape that reads some rows best, and its score."""
    best, most = SHAPES[0], -1.0
    for shape in SHAPES:
        long = shape(table)
        if long is not None and (points := score(long, table)) >= most:
            best, most = shape, points
    return best, most


def with_best_shape(log: Log) -> Log:
    """The log with its signals as the best shape reads them; a table of columns is left alone."""
    if log.sample is None:
        return log
    shape, _ = best_shape(table_of(log.sample, log.units))
    if shape is columns:
        return log
    table = table_of(log.read(dict.fromkeys(log.sample, "")), log.units)
    long = shape(table)
    signals = long.signals if long is not None else ()
    spans = [(float(s.times.min()), float(s.times.max())) for s in signals if s.times is not None]
    return _log_of(long, log) if long is not None and spans and share_time(spans) else log


def table_of(columns: Mapping[str, Any], units: Mapping[str, str]) -> CellTable:
    """A table of columns as they were read, with texts where they are no numbers or dates."""
    out: dict[str, NDArray[Any]] = {}
    dated = set()
    for name, cells in columns.items():
        try:
            texts = np.asarray(cells).dtype.kind in "OU" and is_column_of_texts(cells)
            out[name] = np.asarray(cells, object) if texts else numbers_of(cells, name, "")
        except ExperimentError:
            out[name] = np.array([as_text(c) for c in np.asarray(cells).reshape(-1)], object)
        if holds_dates(cells):
            dated.add(name)
    longest = max(map(len, out.values()), default=0)
    return CellTable({n: x for n, x in out.items() if len(x) == longest}, units, frozenset(dated))


def _log_of(long: LongTable, log: Log) -> Log:
    """The log of a long table, with one time where all clocks are the same."""
    timed = [(s.times, s.clock, s.time_unit) for s in long.signals if s.times is not None]
    times, clock, time_unit = timed[0]
    notes = [*log.notes, *filter(None, [long.note])]
    named = {s.clock for s in long.signals}
    arrays: dict[str, Any] = {}
    clocks: dict[str, str] = {}
    if len(named) == 1 or all(np.array_equal(times, other) for other, *_ in timed):
        time = clock if len(named) == 1 or "time" in {s.name for s in long.signals} else "time"
        arrays = {time: times, **{s.name: s.values for s in long.signals}}
        units = {time: time_unit} if time_unit else {}
    else:
        seconds = _seconds_of(long.signals)
        for s in long.signals:
            arrays |= {s.clock: seconds[s.clock], s.name: s.values}
            clocks[s.name] = s.clock
        units = dict.fromkeys(seconds, "s")
        firsts = {clock: name for name, clock in reversed(clocks.items())}
        shown = join_names(reversed(firsts.values()), most=4)
        notes += [] if long.note else [f"signals with times of their own: {shown}"]
    units |= {s.name: s.unit for s in long.signals if s.unit}

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        return {name: arrays[name] for name in wanted}

    return replace(log, names=(*arrays,), read=read, units=units, notes=tuple(notes), clocks=clocks)


def _seconds_of(signals: Iterable[LongSignal]) -> dict[str, Array]:
    """The times of each clock in s, by the unit that the file states, or by their steps.

    One program wrote all clocks without a unit, in one unit: steps of 0.1 alone would be seconds,
    but are 0.1 ms beside steps of 1. Times of long ago count from the first one.
    """
    clocks = {
        s.clock: (unwrap_stamps(s.times)[0], s.time_unit) for s in signals if s.times is not None
    }
    slowest = max((t for t, _ in clocks.values()), key=lambda t: float(np.median(np.diff(t))))
    usual = unit_of_steps(slowest)[0]
    out = {c: t * si_factor(unit or usual, quantity="time") for c, (t, unit) in clocks.items()}
    begin = min(float(t[0]) for t in out.values())
    return {c: t - begin for c, t in out.items()} if abs(begin) > DATE else out

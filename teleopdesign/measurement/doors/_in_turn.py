"""Tables whose rows belong to several machines in turn: each of them is read with its own clock.

    motor_id; t;     pos;  cmd           joint, time, position, effort
    1;        0.000; 0.10; 0.2           hip,   0.00, 0.10,     1.5
    2;        0.001; 2.30; 0.0           knee,  0.00, 2.30,     0.1
    1;        0.005; 0.11; 0.2           hip,   0.01, 0.11,     1.5

A logger may also write some hundred rows of one machine, then those of the other one, without any
column that tells the two apart: there, the time is set back to where an earlier part ended. Read as
one body, such a table would leap between the machines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import ExperimentError
from ...base.units import measures, si_factor
from ._cells import is_number, number_of, seconds_of
from ._log import Array, Log, join_names

#: words of the name of a column that names or numbers machines
NUMBERS_MACHINES = frozenset(
    "id ids no nr num number name motor joint servo axis actuator node device drive can leg".split()
)
#: most machines of a table, and least rows of each among the first rows of the table
MOST_MACHINES, FEWEST_ROWS = 64, 10
#: first rows of a table that are looked at: batches of up to 200 rows of two machines come back
MOST_ROWS = 1000
#: part of the shortest machine's time for which all run together
TOGETHER = 0.5
#: part that the steps from row to row of the table shrink by within each machine
SMOOTHER = 0.5
#: part of the rows that belong to another machine than the row before, unless the time is set back:
#: the direction of one machine lasts for several rows
EACH_ROW = 0.7
#: longest step within one machine, in usual steps: a logger loses a few rows between two parts
GOES_ON = 5.0
#: returns to an earlier part from which a table without a column of machines is read so: a clock
#: that is set back once or twice may come to rest there by chance
FEWEST_RETURNS = 3


@dataclass(frozen=True)
class Turns:
    """How the rows of a table belong to machines.

    column: that names the machine of each row, None: the times tell it
    names: of the machines;  time: the column of time
    """

    column: str | None
    names: tuple[str, ...]
    time: str


def turns_of(names: Sequence[str], rows: Iterable[Sequence[str]], comma: bool) -> Turns | None:
    """How the first rows of a table belong to several machines; None: to one machine.

    rows: as cells
    """
    table = [row for row in islice(rows, MOST_ROWS) if len(row) == len(names)]
    time = _time_of(names)
    if time is None or len(table) < 2 * FEWEST_ROWS:
        return None
    cells = dict(zip(names, zip(*table, strict=True), strict=True))
    stamps = _values(cells[time], comma)
    if not np.all(np.isfinite(stamps)):
        return None
    others = [n for n in names if n != time]
    for name in others:
        labels = _labels_of(name, cells[name], comma)
        if labels is None:
            continue
        signals = [_values(cells[n], comma) for n in others if n != name]
        if _run_together(labels, stamps, signals):
            return Turns(name, tuple(dict.fromkeys(cells[name])), time)
    parts, returns = parts_by_time(stamps)
    count = int(parts.max()) + 1
    if returns < FEWEST_RETURNS or returns <= count or count > MOST_MACHINES:
        return None
    return Turns(None, tuple(f"part {k + 1}" for k in range(count)), time)


def _time_of(names: Sequence[str]) -> str | None:
    from ..column_names import likeness

    best = max(names, key=lambda name: likeness(name, "time"))
    return best if likeness(best, "time") > 0.0 else None


def _values(cells: Sequence[str], comma: bool) -> Array:
    """The numbers or dates in some cells; NaN where there is none."""

    def value(cell: str) -> float:
        number = number_of(cell, comma=comma)
        if isinstance(number, float):
            return number
        date = seconds_of(cell)
        return np.nan if date is None else date

    return np.array([value(cell) for cell in cells])


def _labels_of(name: str, cells: Sequence[str], comma: bool) -> NDArray[np.intp] | None:
    """The number of each row's machine, where a column may name machines."""
    from ..column_names import words_of

    distinct = list(dict.fromkeys(cells))
    if not 2 <= len(distinct) <= MOST_MACHINES or "" in distinct:
        return None
    numbers = [cell for cell in distinct if is_number(cell, comma)]
    if numbers:
        words = words_of(name)
        whole = all(cell.strip("+").isdigit() for cell in distinct)
        if not whole or not words or not NUMBERS_MACHINES.issuperset(words):
            return None
    elif any(seconds_of(cell) is not None for cell in distinct):
        return None
    return np.array([distinct.index(cell) for cell in cells])


def _run_together(labels: NDArray[np.intp], stamps: Array, signals: Sequence[Array]) -> bool:
    """Whether the machines of some rows run at the same time, each with signals of its own.

    Trials follow each other. The state of one machine lasts for some rows, or changes without a
    leap of its signals.
    """
    rows = [np.flatnonzero(labels == k) for k in range(int(labels.max()) + 1)]
    changes = np.diff(labels) != 0
    if min(map(len, rows)) < FEWEST_ROWS or int(changes.sum()) < 2 * len(rows):
        return False
    if any(np.any(np.diff(stamps[r]) < 0) for r in rows):
        return False
    begins, ends = ([float(stamps[r[k]]) for r in rows] for k in (0, -1))
    shortest = min(e - b for b, e in zip(begins, ends, strict=True))
    if min(ends) - max(begins) < TOGETHER * shortest:
        return False
    if int(np.sum(np.diff(stamps)[changes] < 0)) >= len(rows):
        return True
    in_turn = float(changes.mean()) >= EACH_ROW
    return in_turn and any(_leaps_between(signal, rows) for signal in signals)


def _leaps_between(signal: Array, rows: Sequence[NDArray[np.intp]]) -> bool:
    """Whether a signal changes less within the rows of each machine than from row to row."""
    if not np.all(np.isfinite(signal)):
        return False
    within = sum(float(np.abs(np.diff(signal[r])).sum()) for r in rows)
    return within < SMOOTHER * float(np.abs(np.diff(signal)).sum())


def parts_by_time(stamps: Array) -> tuple[NDArray[np.intp], int]:
    """The part that each row continues, from 0, and how often the rows return to an earlier part.

    A part goes on where the next stamp lies at most `GOES_ON` usual steps after its last one.
    """
    steps = np.diff(stamps)
    forward = steps[steps > 0]
    longest = GOES_ON * float(np.median(forward)) if len(forward) else 0.0
    last, now, returns = [0], 0, 0
    begins, parts = [0], [0]
    for row in (np.flatnonzero((steps < 0) | (steps > longest)) + 1).tolist():
        last[now] = row - 1
        after = {k: float(stamps[row] - stamps[end]) for k, end in enumerate(last) if k != now}
        near = {k: step for k, step in after.items() if 0 < step <= longest}
        if near:
            now = min(near, key=lambda k: near[k])
            returns += 1
        elif steps[row - 1] < 0:
            last.append(row)
            now = len(last) - 1
            if now > MOST_MACHINES:
                break
        begins.append(row)
        parts.append(now)
    return np.repeat(np.array(parts, dtype=np.intp), np.diff([*begins, len(stamps)])), returns


def machines_apart(log: Log) -> Log:
    """A log of records or arrays, with the columns of each machine where its rows take turns.

    Only a column whose name says that it names machines is looked at: others are read twice else.
    """
    from ..column_names import words_of

    may_name = any(
        words and NUMBERS_MACHINES.issuperset(words) for words in map(words_of, log.names)
    )
    if log.clocks or not may_name or len(set(log.names)) < len(log.names):
        return log
    try:
        columns = log.read(dict.fromkeys(log.names, ""))
    except ExperimentError:  # the message belongs to the column that is wanted
        return log
    texts = {n: [_as_text(cell) for cell in np.asarray(c)[:MOST_ROWS]] for n, c in columns.items()}
    if len(set(map(len, texts.values()))) != 1:
        return log
    turns = turns_of(log.names, zip(*texts.values(), strict=True), False)
    if turns is None or turns.column is None:
        return log
    return with_machines_apart(
        log, turns, lambda name: [*map(_as_text, np.asarray(log.read({name: ""})[name]))]
    )


def _as_text(cell: Any) -> str:
    """A cell as a text table holds it: 2.0 of a column of numbers is "2"."""
    if isinstance(cell, float | np.floating) and float(cell).is_integer():
        return str(int(cell))
    return "" if cell is None else str(cell)


def with_machines_apart(
    log: Log, turns: Turns, cells_of_column: Callable[[str], Sequence[str]]
) -> Log:
    """The log with the columns of each machine, which have its own clock: "hip.position".

    cells_of_column: function that reads a column as text, one cell for each row of `log`
    """
    from ..numbers_in_cells import holds_dates, numbers_of

    @cache
    def rows() -> tuple[Array, NDArray[np.intp]]:
        read_time = log.read({turns.time: "channels.time"})[turns.time]
        stamps = numbers_of(read_time, turns.time, "log")
        if turns.column is None:
            machine = parts_by_time(stamps)[0]
        else:
            order = {name: k for k, name in enumerate(turns.names)}
            cells = cells_of_column(turns.column)
            machine = np.array([order.get(cell, -1) for cell in cells], dtype=np.intp)
        scale = 1.0 if holds_dates(read_time) else _scale(log, turns.time, stamps[machine == 0])
        return stamps * scale, machine

    signals = [n for n in log.names if n not in (turns.column, turns.time)]
    columns = {f"{m}.{n}": (k, n) for k, m in enumerate(turns.names) for n in signals}
    times = {f"{m}.{turns.time}": k for k, m in enumerate(turns.names)}
    units = {f"{m}.{n}": log.units[n] for m in turns.names for n in signals if n in log.units}

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        seconds, machine = rows()
        of_table = {columns[w][1]: channel for w, channel in wanted.items() if w in columns}
        values = log.read(of_table) if of_table else {}
        out: dict[str, Any] = {}
        for w in wanted:
            k, source = (times[w], seconds) if w in times else (columns[w][0], None)
            source = values[columns[w][1]] if source is None else source
            out[w] = np.asarray(source)[machine == k]
        return out

    how = f"named in {turns.column!r}" if turns.column else "told apart by their times"
    note = f"rows of {len(turns.names)} machines in turn, {how}: {join_names(turns.names, most=4)}"
    return replace(
        log,
        names=(*times, *columns),
        read=read,
        units={**units, **dict.fromkeys(times, "s")},
        notes=(*log.notes, note),
        clocks={w: f"{turns.names[k]}.{turns.time}" for w, (k, _) in columns.items()},
    )


def _scale(log: Log, column: str, stamps: Array) -> float:
    """Seconds in the unit of a column of time; stamps: those of one machine."""
    from ..column_names import unit_in_name
    from ..stamp_unit import unit_of_steps

    unit = log.units.get(column) or unit_in_name(column, "time")
    if unit is None or not measures(unit, "time"):
        unit = unit_of_steps(stamps)[0]
    return si_factor(unit, quantity="time")

"""Tables whose signals do not share one column of times.

Studios of drives, scopes of controllers and simulators write a time before each signal, viewers of
topics a number only at the times of its signal. Clocks of operating systems and of ROS count whole
seconds and their parts, and loggers write a time of day beside its ms. Rows belong to several
machines in turn, which a column names, or hold one reading each, as viewers of bags, data bases and
decoders of a bus write them.
"""

from __future__ import annotations

import itertools
from bisect import bisect
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....base.units import measures, si_factor
from ...column_names import likeness, unit_of_text, words_of
from ...encoder import Array, is_most
from ...limits import HALF
from ...stamps import step_deviations, unwrap_stamps
from .._header import UNIT_LABELS, bare_unit
from .._log import MOST_PARTS, MOST_SIGNALS, bare_column, join_names
from ._table import (
    AS_EVEN_AS_A_CLOCK,
    FEWEST_ROWS,
    CellTable,
    LongSignal,
    LongTable,
    as_text,
    rises,
    time_of,
)

#: last words of the names of the columns that name the signal of a row, and that hold its reading
SIGNALS = frozenset("topic signal channel variable tag parameter series measurement".split())
READINGS = frozenset("value values reading wert valeur valor".split())

#: words of the name of a column that names or numbers machines
NUMBERS_MACHINES = frozenset(
    "id ids no nr num number name motor joint servo axis actuator node device drive can leg".split()
)

#: last words of the names of whole seconds, and of their part with its unit
SECONDS = frozenset("s sec secs second seconds".split())
PARTS = {
    **dict.fromkeys("ns nsec nsecs nanosec nanosecs nanosecond nanoseconds".split(), "ns"),
    **dict.fromkeys("us usec usecs microsec microsecs microsecond microseconds".split(), "us"),
    **dict.fromkeys("ms msec msecs millisec millisecs millisecond milliseconds".split(), "ms"),
}


def clock_before_signals(table: CellTable) -> LongTable | None:
    """A time before each signal or group of signals: "time, Force, time, Position"."""
    clock_of = _clocks_before(table)
    short, signals = _short_names(clock_of), list[LongSignal]()
    for name, clock in clock_of.items():
        rows = np.isfinite(table.numeric[clock])
        signals.append(table.signal(name, rows, clock, f"time of {short[name]}", short[name]))
    return LongTable(tuple(signals)) if signals else None


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


def separate_clocks(table: CellTable) -> LongTable | None:
    """Signals with numbers only at their own times, as viewers export topics: "0.1, , 1.5"."""
    filled = {n: _is_filled(x) for n, x in table.columns.items()}
    share = {n: float(mask.mean()) if len(mask) else 0.0 for n, mask in filled.items()}
    full = [n for n, part in share.items() if part == 1.0]
    if len(full) != 1 or likeness(full[0], "time") == 0.0 or full[0] not in table.numeric:
        return None  # beside a signal with numbers in all rows, another one has lost them
    partial = {n: mask for n, mask in filled.items() if 0.0 < share[n] < 1.0}
    # a channel that loses more readings than it keeps could not be used on the clock of others
    if not any(is_most(~mask) for mask in partial.values()):
        return None
    time, groups = full[0], dict[bytes, str]()
    signals = []
    for name, mask in partial.items():
        first = groups.setdefault(mask.tobytes(), name)
        signals.append(table.signal(name, mask, time, f"{time} of {first}"))
    return LongTable(tuple(signals))


def _is_filled(column: NDArray[Any]) -> NDArray[np.bool_]:
    if column.dtype.kind == "f":
        return np.asarray(np.isfinite(column))
    return np.array([bool(cell) for cell in column], dtype=bool)


def two_part_time(table: CellTable) -> LongTable | None:
    """Whole seconds, and the part of the second beside them: "stamp.sec, stamp.nanosec".

    Either column alone would be a wrong time: the seconds stand still, and their part is set back
    each second.
    """
    for first, second, unit in _parts_of_times(table.names):
        whole, part = (table.numeric.get(n) for n in (first, second))
        if whole is None or part is None:
            continue
        second_in = si_factor(unit, quantity="time")
        if not are_parts_of_time(whole, part, per_second=1.0 / second_in):
            continue
        stem = _stem(first)[0] if _stem(first)[1] in SECONDS else f"{first} + {second}"
        time = stem or "time"
        time = f"{first} + {second}" if time in table.names else time
        times = np.asarray(unwrap_stamps(whole)[0] + second_in * part)
        signals = tuple(
            LongSignal(n, x, time, times, table.units.get(n, ""), "s")
            for n, x in table.columns.items()
            if n not in (first, second)
        )
        note = f"a time in two columns: {first!r} in s, and {second!r} in {unit}"
        return LongTable(signals, len(whole), note)
    return None


def are_parts_of_time(whole: Array, part: Array, *, per_second: float) -> bool:
    """Whether two columns (n,) are the seconds of a time and the parts of these seconds."""
    filled = np.isfinite(whole) & np.isfinite(part)
    whole, part = unwrap_stamps(whole[filled])[0], part[filled]
    if len(whole) < 2 or not np.array_equal(whole, np.round(whole)):
        return False
    if part.min() < 0 or part.max() >= per_second or part.max() < HALF * per_second:
        return False
    turns = np.diff(whole)
    return bool(turns.any() and np.all((turns >= 0) & ((turns > 0) | (np.diff(part) >= 0))))


def _parts_of_times(names: Sequence[str]) -> Iterator[tuple[str, str, str]]:
    """Columns of one stem whose last words are a second and a part of it: "stamp.sec".

    A column called "ms" alone may hold the part of a time of day beside it, without fractions. So
    may the first two columns where no column has a name.
    """
    if names[0] == "column 1" and len(names) > 2:
        yield from ((names[0], names[1], unit) for unit in ("ns", "us"))
    alone = [name for name in names if _stem(name)[0] == "" and _stem(name)[1] in PARTS]
    if len(alone) == 1:
        for first in (name for name in names if likeness(name, "time") > 0.0):
            yield first, alone[0], PARTS[_stem(alone[0])[1]]
    seconds = [name for name in names if _stem(name)[1] in SECONDS]
    parts = [name for name in names if _stem(name)[1] in PARTS]
    for first, second in itertools.product(seconds, parts):
        if _stem(first)[0] == _stem(second)[0]:
            yield first, second, PARTS[_stem(second)[1]]


def _stem(name: str) -> tuple[str, str]:
    """A name without its last word, and this word in lower case: ("header.stamp", "nanosec")."""
    end = max(name.rfind(sign) for sign in "._ /")
    return name[: max(end, 0)].rstrip("._ /"), name[end + 1 :].strip("()[]").lower()


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
    if int(np.sum(np.diff(stamps)[changes] < 0)) >= len(rows):
        return True
    in_turn = float(changes.mean()) >= HALF
    return in_turn and any(_leaps_between(signal, rows) for signal in signals)


def _leaps_between(signal: Array, rows: Sequence[NDArray[np.intp]]) -> bool:
    """Whether a signal changes less within the rows of each machine than from row to row."""
    within = sum(float(np.abs(np.diff(signal[r])).sum()) for r in rows)
    return within < HALF * float(np.abs(np.diff(signal)).sum())


def _apart(
    table: CellTable, time: str, key: str, labels: tuple[list[str], NDArray[np.intp]]
) -> LongTable:
    """The signals of each machine, with its own clock: "hip.position" at "hip.time"."""
    names, machine = labels
    signals = []
    for k, name in enumerate(names):
        for n in (n for n in table.names if n not in (time, key)):
            signals.append(table.signal(n, machine == k, time, f"{name}.{time}", f"{name}.{n}"))
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

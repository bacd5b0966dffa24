"""Tables in which each signal has numbers only at its own times, as PlotJuggler writes topics.

    __time, /joint/position, /command
    0.000,  0.10,
    0.002,           , 1.5
    0.010,  0.11,

Each group of columns that have numbers in the same rows is read with a clock of its own, as each
topic of a bag is.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..time_grid import DATE
from ._cells import is_empty
from ._log import Array, Log, join_names
from ._seconds import seconds_of

#: a column with numbers in less than this part of the rows has a clock of its own: a channel that
#: loses more readings than it keeps could not be used either
SELDOM = 0.5


def groups_of(names: Sequence[str], rows: Iterable[Sequence[str]]) -> tuple[str, list[list[str]]]:
    """The column of time, and the groups of columns with numbers in the same rows only.

    rows: the first rows of the table, as cells
    returns: "" and no group where no column has a clock of its own
    """
    from ..column_names import likeness

    width = len(names)
    marks = (bytes(not is_empty(cell) for cell in row) for row in rows if len(row) == width)
    filled = np.frombuffer(b"".join(marks), dtype=bool).reshape(-1, width)
    if not len(filled):
        return "", []
    share = filled.mean(axis=0)
    full = [n for n, s in zip(names, share, strict=True) if s == 1.0]
    seldom = np.any((share > 0.0) & (share < SELDOM)) or _never_share_a_row(filled, share)
    if not seldom or len(full) != 1:
        return "", []  # beside a signal with numbers in all rows, another one has lost them
    time = full[0]
    if likeness(time, "time") == 0.0:
        return "", []
    groups: dict[bytes, list[str]] = {}
    for name, column, part in zip(names, filled.T, share, strict=True):
        if 0.0 < part < 1.0:
            groups.setdefault(column.tobytes(), []).append(name)
    return time, list(groups.values())


def _never_share_a_row(filled: NDArray[np.bool_], share: Array) -> bool:
    """Whether two columns have no row in common: two topics at one rate fill half of the rows each.

    Columns of one clock that lost some readings have most of the others in common.
    """
    partial = filled[:, (share > 0.0) & (share < 1.0)].astype(np.int64)
    return bool(np.any(partial.T @ partial == 0)) if partial.size else False


def with_separate_clocks(log: Log, file: str, time: str, groups: Sequence[Sequence[str]]) -> Log:
    """The log with a column of times for each group; its columns hold their rows with numbers only.

    time: column with the time of all rows;  groups: of `groups_of`
    The times of a group are in seconds, from the first row where they count from long ago.
    """

    @cache
    def seconds() -> Array:
        times = seconds_of(log, time, file)
        return times - times[0] if len(times) and abs(times[0]) > DATE else times

    clock_of = {name: f"{time} of {group[0]}" for group in groups for name in group}
    first_of = {f"{time} of {group[0]}": group[0] for group in groups}
    plain = {n: time for n in log.names if n not in clock_of and n != time}

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        clocks = {clock_of.get(w, w) for w in wanted} & set(first_of)
        of_table = {w: channel for w, channel in wanted.items() if w not in first_of}
        values = log.read({**{first_of[clock]: "" for clock in clocks}, **of_table})
        here = {clock: np.isfinite(values[first_of[clock]]) for clock in clocks}
        out = {w: seconds() if w in first_of else values[w] for w in wanted}
        for w in wanted:
            if (clock := clock_of.get(w, w)) in here:
                out[w] = out[w][here[clock]]
        return out

    firsts = join_names([group[0] for group in groups], most=4)
    note = f"signals with times of their own: {firsts}"
    return replace(
        log,
        names=(*log.names, *first_of),
        read=read,
        units={**log.units, **dict.fromkeys(first_of, "s")},
        notes=(*log.notes, note),
        clocks={**plain, **clock_of},
    )

"""Readings that are slower than the rows of their log: they get a clock of their own.

A program that joins the messages of several devices or sensors into one table repeats those of the
slower one until its next reading. Held readings would look like a motion in steps on a clock that
jitters, or like a sensor with a delay that varies.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from .channel import Channel
from .repeated_rows import rows_between_readings
from .row_places import Array
from .tables import LogColumns

#: quantities that a sensor reads, also where it is slower than the controller
SENSED = ("position", "interaction_force")


def with_slower_signals(
    columns: LogColumns, channels: Sequence[Channel], stamps: Array
) -> LogColumns:
    """The columns; those of slower bodies and sensors have one value and stamp for each reading.

    stamps: (n,) s, of the rows
    Where all channels change together, the whole log has a slower source, and its rows are left out
    instead (`clock_of_log`). A command that alone changes seldom is held by its controller, and
    stays as it is.
    """
    usable = len(stamps) and np.isfinite(stamps).all()
    if not usable or _reads_slowly(columns, channels, stamps).any():
        return columns
    values, slow_stamps = dict(columns.values), dict(columns.stamps)
    for signals in _sources(columns, channels, stamps):
        between = _reads_slowly(columns, signals, stamps)
        if between.any():
            for column in _columns(columns, signals):
                values[column] = columns.values[column][~between]
                slow_stamps[column] = stamps[~between]
    return replace(columns, values=values, stamps=slow_stamps)


def _sources(
    columns: LogColumns, channels: Sequence[Channel], stamps: Array
) -> Iterator[list[Channel]]:
    """Channels that may have a clock of their own: of a slower body all, else each sensor."""
    bodies = dict.fromkeys(ch.body for ch in channels if ch.body is not None)
    for body in bodies:
        signals = [ch for ch in channels if ch.body == body]
        if len(bodies) > 1 and _reads_slowly(columns, signals, stamps).any():
            yield signals
        else:
            yield from ([s] for s in signals if s.quantity in SENSED)


def _columns(columns: LogColumns, signals: Sequence[Channel]) -> list[str]:
    """Columns of signals on the clock of the log."""
    every = {c for s in signals if s.body is not None for c in s.columns}
    return sorted(c for c in every if c not in columns.stamps)


def _reads_slowly(columns: LogColumns, signals: Sequence[Channel], stamps: Array) -> np.ndarray:
    """Mask (n,) of the rows between two readings of these signals; none where a cell is empty."""
    sensed = _columns(columns, [s for s in signals if s.quantity == "position"] or signals)
    every = [columns.values[c] for c in _columns(columns, signals)]
    if not all(len(x) == len(stamps) and np.isfinite(x).all() for x in every):
        return np.zeros(len(stamps), dtype=bool)
    return rows_between_readings(every, [columns.values[c] for c in sensed], stamps)

"""Readings that are slower than the rows of their log: they get a clock of their own.

A program that joins the messages of several devices or sensors into one table repeats those of the
slower one until its next reading. Held readings would look like a motion in steps on a clock that
jitters, or like a sensor with a delay that varies.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from .channel import Channel
from .record_clock import Array, counted_time
from .repeated_rows import rows_between_readings
from .tables import LogColumns
from .time_grid import DATE

#: quantities that a sensor reads, also where it is slower than the controller
SENSED = ("position", "interaction_force")


def with_slower_signals(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    name: str,
    *,
    sample_rate: float | None,
    to_seconds: float | None,
) -> LogColumns:
    """The columns; those of slower bodies and sensors have one value and stamp for each reading.

    name, sample_rate, to_seconds: as in `clock_of_log`
    Where all channels change together, the whole log has a slower source, and its rows are left out
    instead (`clock_of_log`). A command that alone changes seldom is held by its controller, and
    stays as it is.
    """
    if "segment" in channels:
        return columns
    stamps = _stamps(columns, channels, name, sample_rate, to_seconds)
    if stamps is None or _reads_slowly(columns, [*channels.values()], stamps).any():
        return columns
    values, slow_stamps = dict(columns.values), dict(columns.stamps)
    for signals in _sources(columns, channels, stamps):
        between = _reads_slowly(columns, signals, stamps)
        if not between.any():
            continue
        for column in _columns(columns, signals):
            values[column] = columns.values[column][~between]
            slow_stamps[column] = stamps[~between]
    return replace(columns, values=values, stamps=slow_stamps)


def _sources(
    columns: LogColumns, channels: Mapping[str, Channel], stamps: Array
) -> list[list[Channel]]:
    """Channels that may have a clock of their own: of a slower body all, else each sensor."""
    of_body: dict[str, list[Channel]] = {}
    for channel in channels.values():
        if channel.body is not None:
            of_body.setdefault(channel.body, []).append(channel)
    sources = []
    for signals in of_body.values():
        together = len(of_body) > 1 and _reads_slowly(columns, signals, stamps).any()
        alone = [[s] for s in signals if s.quantity in SENSED]
        sources += [signals] if together else alone
    return sources


def _stamps(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    name: str,
    sample_rate: float | None,
    to_seconds: float | None,
) -> Array | None:
    """The time of each row, s, as `clock_of_log` counts it; None: a row has none."""
    if sample_rate is not None:
        length = max((len(x) for c, x in columns.values.items() if c not in columns.stamps))
        return counted_time(length, sample_rate, name)[0]
    stamps = columns.values[channels["time"].column] * (to_seconds or 1.0)
    if not (len(stamps) and np.isfinite(stamps).all()):
        return None
    return stamps - stamps[0] if abs(stamps[0]) > DATE else stamps


def _columns(columns: LogColumns, signals: list[Channel]) -> list[str]:
    """Columns of signals on the clock of the log."""
    every = {c for s in signals if s.body is not None for c in s.columns}
    return sorted(c for c in every if c not in columns.stamps)


def _reads_slowly(columns: LogColumns, signals: list[Channel], stamps: Array) -> np.ndarray:
    """Mask (n,) of the rows between two readings of these signals; none where a cell is empty."""
    sensed = _columns(columns, [s for s in signals if s.quantity == "position"] or signals)
    every = [columns.values[c] for c in _columns(columns, signals)]
    if not all(len(x) == len(stamps) and np.isfinite(x).all() for x in every):
        return np.zeros(len(stamps), dtype=bool)
    return rows_between_readings(every, [columns.values[c] for c in sensed], stamps)

"""One recording: signals in SI units on a uniform time, and the corrections of its log."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError
from ..base.frozen import ByValue
from ..base.shown import html_table
from .channel import LogLayout, conversion_to_si
from .log_clock import clock_of_log
from .reading import ReadingStep
from .signals_of_log import signals_of_log
from .stamps import seconds_since_first
from .tables import LogColumns, read_columns

#: keys of [[records]] at which "own" gives the record a separate value
SEPARATE = ("position_zero", "bias", "friction_level")


@final
@dataclass(frozen=True, eq=False)
class Record(ByValue):
    """One recording of n samples, for estimation (use "fit") or for errors alone (use "check").

    offset_names: those of "position_zero", "bias" and "friction_level" in which this record may
        differ from the others
    time: s, shape (n,), uniform within each segment with step `sample_time` (s)
    segments: stretches without interruption; hidden states start anew at each
    signals: "device.position", "master.actuator_force" ... -> shape (n,), SI, signs of the format
    reading: corrections of the log, each with its effect; empty: the log is used unchanged
    """

    file: str
    use: str
    offset_names: frozenset[str]
    time: NDArray[np.float64]
    sample_time: float
    segments: tuple[slice, ...]
    signals: Mapping[str, NDArray[np.float64]]
    reading: tuple[ReadingStep, ...] = ()

    @property
    def duration(self) -> float:
        """Length of all segments together, s."""
        return len(self.time) * self.sample_time

    @property
    def is_curve(self) -> bool:
        """Whether the samples are points of a friction curve, without time."""
        return not any(name.endswith(".position") for name in self.signals)

    @property
    def longest(self) -> slice:
        """Rows of the longest segment."""
        return max(self.segments, key=lambda rows: rows.stop - rows.start)

    def rate_of(self, channel: str) -> float:
        """Readings of a channel in a second, Hz: fewer than samples where it was interpolated."""
        rates = [dict(s.numbers)["rate"] for s in self.reading if s.channel == channel]
        return min([*rates, 1.0 / self.sample_time])

    def __repr__(self) -> str:
        if self.is_curve:
            return f"Record {self.file} ({self.use}): {len(self.time)} points"
        segments = f", {len(self.segments)} segments" if len(self.segments) > 1 else ""
        return (
            f"Record {self.file} ({self.use}): {len(self.time)} samples, {self.duration:.6g} s "
            f"at {1 / self.sample_time:.6g} Hz{segments}"
        )

    def _repr_html_(self) -> str:
        rows = [
            (name, f"{values.min():.4g} to {values.max():.4g}", f"{np.std(values):.4g}")
            for name, values in self.signals.items()
        ]
        head = ("signal (SI)", "range", "standard deviation")
        steps = "; ".join(f"{step.observed}: {step.rule}" for step in self.reading)
        return html_table(repr(self), head, rows, note=steps)


class RecordEntry(NamedTuple):
    """One of [[records]]: a file, its use, its separate offsets, and the span (s) that counts."""

    file: str
    use: str
    offset_names: frozenset[str] = frozenset()
    span: tuple[float, ...] | None = None


def read_record(folder: Path, entry: RecordEntry, layout: LogLayout) -> Record:
    """Read one record file of an experiment's folder.

    raises ExperimentError: see `read_columns` and `clock_of`
    """
    name = f"{folder.name}/{entry.file}"
    columns = read_columns(folder / entry.file, name, layout.wanted)
    if (span := entry.span) is not None:
        columns = cut_to(columns, span, layout, name)
        # taken off again by `log_name`
        entry = entry._replace(file=f"{entry.file} {span[0]:g}-{span[1]:g} s")
    return record_of(columns, name, entry, layout)


def cut_to(
    columns: LogColumns,
    span: Sequence[float],
    layout: LogLayout,
    where: str,
) -> LogColumns:
    """The rows of a log between two instants.

    span: (begin, end) in s from the first row; after a clock was set back the seconds count on
    raises ExperimentError: no two numbers in order, or no row between them
    """
    if len(span) != 2 or not np.isfinite(span).all() or not span[0] < span[1]:
        raise ExperimentError(
            f"{where}: span: found {list(span)}, expected [begin, end] in s, from the first row"
        )
    since = seconds_since_first(layout.stamps(columns.values))
    inside = (since >= span[0]) & (since < span[1])
    if not inside.any():
        last = float(np.nanmax(since)) if len(since) else 0.0
        raise ExperimentError(
            f"{where}: span: found no row from {span[0]:g} to {span[1]:g} s, the log ends at "
            f"{last:g} s"
        )
    values = {
        name: column if name in columns.stamps else column[inside]
        for name, column in columns.values.items()
    }
    return LogColumns(values, columns.stamps, columns.notes)


def record_of(columns: LogColumns, name: str, entry: RecordEntry, layout: LogLayout) -> Record:
    """The record from the columns of one log, which are cut to its span.

    name: of the log in messages
    raises ExperimentError: too short, time that does not increase, too many cells without a number
    """
    conversions = {
        key: conversion_to_si(channel, layout.bodies, f"channels.{key}.unit")
        for key, channel in layout.channels.items()
        if channel.body is not None
    }
    clock, columns, steps = clock_of_log(columns, layout, name, file=entry.file)
    signals, more = signals_of_log(columns, layout.channels, conversions, clock, entry.file)
    return Record(
        entry.file,
        entry.use,
        entry.offset_names,
        clock.clock.time,
        clock.clock.sample_time,
        clock.clock.segments,
        signals,
        (*columns.steps(entry.file), *steps, *more),
    )


def short_name(key: str) -> str:
    """The name of a channel without "device.", as in an experiment with one body."""
    return key.removeprefix("device.")

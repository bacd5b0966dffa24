"""One recording: signals in SI units on a uniform time, and the corrections of its log."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np
from numpy.typing import NDArray

from ..base.frozen import ByValue
from ..base.shown import html_table
from .channel import Channel, conversion_to_si, factor_of
from .description import BodyDescription
from .log_clock import clock_of_log
from .reading import ReadingStep
from .signals_of_log import signals_of_log
from .slower_signals import with_slower_signals
from .spans import cut_to
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


def read_record(
    folder: Path,
    file: str,
    *,
    use: str,
    offset_names: frozenset[str],
    channels: Mapping[str, Channel],
    bodies: Mapping[str, BodyDescription],
    sample_rate: float | None,
    span: tuple[float, ...] | None = None,
) -> Record:
    """Read one record file of an experiment's folder.

    sample_rate: Hz; None: the channel "time" gives the time
    span: (begin, end) in s from the log's first row; None: the whole log
    raises ExperimentError: see `read_columns` and `clock_of`
    """
    name = f"{folder.name}/{file}"
    columns = read_columns(folder / file, name, wanted_columns(channels))
    if span is not None:
        columns = cut_to(columns, span, channels, bodies, sample_rate, name)
        file = f"{file} {span[0]:g}-{span[1]:g} s"  # taken off again by `log_name`
    return record_of(
        columns,
        name,
        file=file,
        use=use,
        offset_names=offset_names,
        channels=channels,
        bodies=bodies,
        sample_rate=sample_rate,
    )


def wanted_columns(channels: Mapping[str, Channel]) -> dict[str, str]:
    """Column -> the channel that needs it, as messages name the channel."""
    return {
        column: f"channels.{short_name(key)}"
        for key, channel in channels.items()
        for column in channel.columns
    }


def record_of(
    columns: LogColumns,
    name: str,
    *,
    file: str,
    use: str,
    offset_names: frozenset[str],
    channels: Mapping[str, Channel],
    bodies: Mapping[str, BodyDescription],
    sample_rate: float | None,
) -> Record:
    """The record from the columns of one log.

    name: of the log in messages;  file: of the record
    sample_rate: Hz; None: the log has a time channel
    raises ExperimentError: too short, time that does not increase, too many cells without a number
    """
    conversions = {
        key: conversion_to_si(channel, bodies, f"channels.{key}.unit")
        for key, channel in channels.items()
        if channel.body is not None
    }
    to_seconds = None
    if sample_rate is None:
        to_seconds = factor_of(channels["time"], bodies, "channels.time")
    columns = with_slower_signals(
        columns, channels, name, sample_rate=sample_rate, to_seconds=to_seconds
    )
    clock, steps = clock_of_log(
        columns, channels, name, file=file, sample_rate=sample_rate, to_seconds=to_seconds
    )
    signals, more = signals_of_log(columns, channels, conversions, clock, file)
    return Record(
        file,
        use,
        offset_names,
        clock.clock.time,
        clock.clock.sample_time,
        clock.clock.segments,
        signals,
        (*columns.steps(file), *steps, *more),
    )


def short_name(key: str) -> str:
    """The name of a channel without "device.", as in an experiment with one body."""
    return key.removeprefix("device.")

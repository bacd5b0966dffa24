"""From the rows of a log to the clock of a record, with the reading steps that report it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError, quote
from .channel import Channel
from .reading import ReadingStep, count_of
from .record_clock import RecordClock, counted_time, segments_of
from .repeated_rows import repeated_rows, rows_between_readings
from .tables import LogColumns
from .time_grid import DATE, EVEN, clock_of, stamps_are_true

Array = NDArray[np.float64]

#: a log is refused if more than this part of the rows lack a number in some cell: such a column is
#: another column, or belongs to a slower clock
MOST_EMPTY = 0.2
#: what to do with such a column
OF_ANOTHER_CLOCK = "a signal of a slower clock goes with its times into a table beside, in a folder"
#: standard errors from which the position decides whether the stamps are true
SURE = 3.0


@dataclass(frozen=True)
class LogClock:
    """The clock of a log.

    stamped: True: each row was taken at its stamp; False: the rows lie on the even clock
    """

    clock: RecordClock
    stamped: bool


def clock_of_log(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    name: str,
    *,
    file: str,
    sample_rate: float | None,
    to_seconds: float | None,
) -> tuple[LogClock, list[ReadingStep]]:
    """The clock of a log, with the steps that led to it.

    name: of the log in messages;  sample_rate: Hz; None: the log has a time channel
    to_seconds: factor of the time channel's unit
    raises ExperimentError: see `clock_of`; too many cells without a number
    """
    on_this_clock = {c for c in columns.values if c not in columns.stamps}
    filled = _filled_rows(columns, channels, on_this_clock, name)
    if sample_rate is not None:
        count = len(filled)
        time, sample_time = counted_time(count, sample_rate, name)
        stamps, where = time, name
    else:
        stamps = columns.values[channels["time"].column] * (to_seconds or 1.0)
        where = f"{name}: channels.time"
    labels = _labels(columns, channels, name)
    again = _mark_repeated(columns, channels, on_this_clock, filled) & _mark_later_rows(stamps)
    between = _mark_between_readings(columns, channels, on_this_clock, filled, stamps)
    rows = np.flatnonzero(filled & ~again & ~between)
    stamps = stamps[rows]
    steps: list[ReadingStep] = []
    if len(stamps) and abs(stamps[0]) > DATE:
        stamps = stamps - stamps[0]
        steps.append(
            ReadingStep(file, "stamps that count from long ago", "time from the first row", "none")
        )
    segments = segments_of(None if labels is None else labels[rows], len(rows))
    if sample_rate is not None and len(rows) == len(filled):
        clock = RecordClock(rows, time, rows, time, sample_time, segments, segments)
    else:
        clock = clock_of(stamps, segments, _repeats(columns, channels, rows, on_this_clock), where)
        clock = replace(clock, rows=rows[clock.rows])
    stamped, more = _stamps(clock, columns, channels, file)
    steps += _left_out(file, ~filled, again, between, clock.sample_time)
    return LogClock(clock, stamped), steps + _order(clock, file, len(filled)) + more


def _left_out(
    file: str,
    empty: NDArray[np.bool_],
    again: NDArray[np.bool_],
    between: NDArray[np.bool_],
    sample_time: float,
) -> list[ReadingStep]:
    """Reading steps for rows that are not used; the masks cover all rows."""
    steps = []
    if empty.any():
        reason = f"{count_of(int(empty.sum()), 'row')} with a cell that holds no number"
        part = f"{100 * float(empty.mean()):.2g} % of the rows"
        steps.append(ReadingStep(file, reason, "read as lost", part))
    if again.any():
        reason = f"{count_of(int(again.sum()), 'row')} the same as the one before"
        part = f"{100 * float(again.mean()):.2g} % of the rows"
        steps.append(ReadingStep(file, reason, "read as lost", part))
    if between.any():
        reason = "rows come faster than readings, which all channels change together"
        rule = f"one row of each reading, {1 / sample_time:.4g} a second"
        part = f"{100 * float(between.mean()):.2g} % of the rows say nothing new"
        steps.append(ReadingStep(file, reason, rule, part))
    return steps


def _filled_rows(
    columns: LogColumns, channels: Mapping[str, Channel], on_this_clock: set[str], name: str
) -> NDArray[np.bool_]:
    """Rows with a number in every wanted cell."""
    length = max((len(columns.values[c]) for c in on_this_clock), default=0)
    filled = np.ones(length, dtype=bool)
    for key, channel in channels.items():
        for column in channel.columns:
            if column not in on_this_clock:
                continue
            bad = ~np.isfinite(columns.values[column])
            if len(bad) and bad.mean() > MOST_EMPTY:
                row = int(np.argmax(bad))
                short = key.removeprefix("device.")
                raise ExperimentError(
                    f"{name}: channels.{short}: column {quote(column)}, row {row + 1}: found "
                    f"{columns.values[column][row]:g}, and no number in {bad.mean():.0%} of the "
                    f"rows, expected at most {MOST_EMPTY:.0%}; {OF_ANOTHER_CLOCK}"
                )
            filled &= ~bad
    return filled


def _mark_later_rows(stamps: Array) -> NDArray[np.bool_]:
    """Rows whose stamp exceeds the stamp of the row before by more than half the median step."""
    steps = np.diff(stamps, prepend=stamps[:1])
    forward = steps[steps > 0]
    return np.asarray(steps > 0.5 * np.median(forward)) if len(forward) else steps > 0


def _mark_repeated(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    on_this_clock: set[str],
    filled: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Filled rows for which the logger had no new reading."""
    every, of = _columns_by_quantity(columns, channels, on_this_clock, filled)
    repeated = np.zeros(len(filled), dtype=bool)
    if every and filled.any():
        repeated[filled] = repeated_rows(every, of("position"), of("interaction_force"))
    return repeated


def _mark_between_readings(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    on_this_clock: set[str],
    filled: NDArray[np.bool_],
    stamps: Array,
) -> NDArray[np.bool_]:
    """Rows that the log wrote before its source had a new reading."""
    every, of = _columns_by_quantity(columns, channels, on_this_clock, filled)
    between = np.zeros(len(filled), dtype=bool)
    if len(every) > 1:  # one column alone has the rows of its log
        between[filled] = rows_between_readings(every, of("position"), stamps[filled])
    return between


def _columns_by_quantity(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    on_this_clock: set[str],
    filled: NDArray[np.bool_],
) -> tuple[list[Array], Callable[..., list[Array]]]:
    """The filled rows (n,) of all signal columns, and a function that selects them by quantity."""
    signals = [ch for k, ch in channels.items() if k not in ("time", "segment")]

    def of(*quantities: str) -> list[Array]:
        wanted = {c for ch in signals if ch.quantity in quantities for c in ch.columns}
        return [columns.values[c][filled] for c in sorted(wanted & on_this_clock)]

    return of(*(ch.quantity for ch in signals)), of


def _labels(columns: LogColumns, channels: Mapping[str, Channel], name: str) -> Array | None:
    if "segment" not in channels:
        return None
    labels = columns.values[channels["segment"].column]
    fractional = np.flatnonzero(np.isfinite(labels) & (labels != np.round(labels)))
    if fractional.size:
        raise ExperimentError(
            f"{name}: channels.segment: row {fractional[0] + 1}: found {labels[fractional[0]]:g}, "
            "expected a whole number"
        )
    return labels


def _repeats(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    rows: NDArray[np.intp],
    on_this_clock: set[str],
) -> NDArray[np.bool_]:
    """Rows equal to the row before in every channel except the time."""
    same = np.ones(len(rows), dtype=bool)
    same[:1] = False
    for key, channel in channels.items():
        for column in channel.columns:
            if key != "time" and column in on_this_clock:
                same[1:] &= np.diff(columns.values[column][rows]) == 0
    return same


def _order(clock: RecordClock, file: str, count: int) -> list[ReadingStep]:
    """Reading steps for repeated stamps, rows out of order, clocks set back and pauses."""
    steps = []
    if clock.dropped:
        text = f"{count_of(clock.dropped, 'row')} with the stamp of another"
        steps.append(ReadingStep(file, text, "the first of each is used", "none"))
    if clock.sorted:
        text = f"{count_of(clock.sorted, 'row')} out of order"
        steps.append(ReadingStep(file, text, "sorted by their stamps", "none"))
    if clock.counted:
        text = "stamps that many rows share"
        rule = "rows are counted at the mean rate"
        effect = "lost rows cannot be seen in such stamps"
        steps.append(ReadingStep(file, text, rule, effect))
    if clock.restarts:
        text = f"time set back {count_of(clock.restarts, 'time')}"
        rule = "a new segment each time"
        steps.append(ReadingStep(file, text, rule, "hidden states start anew at each"))
    if clock.alone:
        text = f"{count_of(clock.alone, 'row')} with a pause or an end on both sides"
        steps.append(ReadingStep(file, text, "left out: one row tells no motion", "none"))
    if clock.gaps:
        text = f"{count_of(clock.gaps, 'pause')}, the longest {clock.longest_gap:.3g} s"
        rule = "a new segment after each"
        steps.append(ReadingStep(file, text, rule, "hidden states start anew at each"))
    return steps


def _stamps(
    clock: RecordClock, columns: LogColumns, channels: Mapping[str, Channel], file: str
) -> tuple[bool, list[ReadingStep]]:
    """Whether each row was taken at its stamp, with the reading steps that report it."""
    h = clock.sample_time
    if clock.counted or clock.jitter <= EVEN * h:
        return False, []
    named = [
        column
        for channel in channels.values()
        if channel.quantity == "position"
        for column in channel.columns
        if column not in columns.stamps
    ]
    positions = [columns.values[c][clock.rows] for c in named]
    if math.isinf(clock.jitter):
        steps = np.diff(clock.stamps) / h
        text = f"uneven stamps, steps of {steps.min():.2g} to {steps.max():.2g} times {h:.3g} s"
        rule = "each row at its own stamp: positions interpolated, commands held"
        numbers = (
            ("rate", 1.0 / h),
            ("shortest", float(steps.min())),
            ("longest", float(steps.max())),
        )
        effect = _effect_of_even_stamps(clock, positions)
        done = ReadingStep(file, text, rule, effect, topic="sample clock", numbers=numbers)
        return True, [replace(done, interpolates=True)]
    slope, error = stamps_are_true(clock, positions)
    off = float(f"{100 * clock.jitter / h:.2g}")
    text = f"stamps {off:g} % of a row off an even clock"
    share = f"{slope:.2f} +- {error:.1g} of what they say"
    sure = abs(slope - 0.5) > SURE * error
    stamped = slope > 0.5 and math.isfinite(error)
    if stamped:
        rule = (
            f"the position was read at its stamps ({share}): positions interpolated, commands held"
        )
        effect = _effect_of_even_stamps(clock, positions)
    else:
        rule = f"read on an even clock, for the position does not follow the stamps ({share})"
        effect = "none"
    if not sure:
        effect = "the position hardly tells, so that it makes little difference"
    numbers = (("jitter", clock.jitter), ("rate", 1.0 / h), ("followed", slope))
    done = ReadingStep(file, text, rule, effect, topic="sample clock", numbers=numbers)
    return stamped, [replace(done, interpolates=stamped)]


def _effect_of_even_stamps(clock: RecordClock, positions: list[Array]) -> str:
    """The error of the position if the stamps were read as even, as a text."""
    off = clock.stamps - clock.time[clock.places]
    speeds = [
        float(np.sqrt(np.mean((np.gradient(x, clock.stamps) * off) ** 2)))
        / max(float(np.ptp(x)), 1e-300)
        for x in positions
    ]
    if not speeds:
        return "none"
    return f"read as even, positions would err by {100 * max(speeds):.2g} % of the travel"

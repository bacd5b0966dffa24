"""From the rows of a log to the clock of a record, with the reading steps that report it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError, quote
from ..base.sentences import percent
from .channel import Channel, LogLayout
from .encoder import SURELY, Array
from .limits import HALF
from .reading import ReadingStep, count_of
from .record_clock import DATE, EVEN, RecordClock, clock_of, counted_clock, segments_of
from .repeated_rows import MOST, repeated_rows, rows_between_readings, with_slower_signals
from .spikes import lost_zeros
from .stamps import usual_step
from .tables import LogColumns

#: what to do with such a column
OF_ANOTHER_CLOCK = "a signal of a slower clock goes with its times into a table beside, in a folder"
#: why rows of a slower source are left out
FASTER = "rows come faster than readings, which all channels change together"
#: channels that are no signals
APART = ("time", "segment")


def clock_of_log(
    columns: LogColumns, layout: LogLayout, name: str, *, file: str
) -> tuple[RecordClock, LogColumns, list[ReadingStep]]:
    """The clock of a log, its columns, and the steps that led to it.

    name: of the log in messages;  file: of the record
    returns: columns of slower bodies and sensors have stamps of their own
    raises ExperimentError: see `clock_of`; too many cells without a number
    """
    channels, sample_rate = layout.channels, layout.sample_rate
    steps: list[ReadingStep] = []
    where = name if sample_rate is not None else f"{name}: channels.time"
    stamps = layout.stamps(columns.values, columns.stamps)
    if len(stamps) and np.abs(stamps[0]) > DATE:
        stamps = stamps - stamps[0]
        text, rule = "stamps that count from long ago", "time from the first row"
        steps.append(ReadingStep(file, text, rule, "none"))
    if "segment" not in channels:
        columns = with_slower_signals(columns, [*channels.values()], stamps)
    written, columns = columns, _without_lost_zeros(columns, channels)
    odd_zero = "" if columns is written else ", or with a 0 to which no motion leads"
    filled = _filled_rows(columns, channels, name)
    labels = _labels(columns, channels, name)
    again, between = _rows_without_reading(columns, channels, filled, stamps)
    rows = np.flatnonzero(filled & ~again & ~between)
    segments = segments_of(None if labels is None else labels[rows], len(rows))
    if sample_rate is not None and len(rows) == len(filled):
        clock = counted_clock(len(rows), sample_rate, segments, where)
    else:
        clock = clock_of(stamps[rows], segments, where)
        clock = replace(clock, rows=rows[clock.rows])
    positions = [
        columns.values[c][clock.rows]
        for ch in channels.values()
        if ch.quantity == "position"
        for c in ch.columns
        if c not in columns.stamps
    ]
    stamped, more_steps = read_at_stamps(clock, positions, file)
    one_each = f"one row of each reading, {1 / clock.sample_time:.4g} a second"
    for left_out, text, rule in (
        (~filled, f"with a cell that holds no number{odd_zero}", "read as lost"),
        (again, "the same as the one before", "read as lost"),
        (between, f"that say nothing new: {FASTER}", one_each),
    ):
        if count := int(np.count_nonzero(left_out)):
            part = f"{percent(count / len(filled), '.2g')} of the rows"
            steps.append(ReadingStep(file, f"{count_of(count, 'row')} {text}", rule, part))
    steps += [ReadingStep(file, *words) for words in clock.remarks]
    return replace(clock, stamped=stamped), columns, steps + more_steps


def _without_lost_zeros(columns: LogColumns, channels: Mapping[str, Channel]) -> LogColumns:
    """The columns, with empty cells for zeros of positions that stand for no reading."""
    values = dict(columns.values)
    for channel in channels.values():
        wraps = channel.conversion.period or channel.conversion.code  # a turn ends at 0, by a leap
        for column in channel.columns if channel.quantity == "position" and not wraps else ():
            if (lost := lost_zeros(values[column])).any():
                values[column] = np.where(lost, np.nan, values[column])
    changed = any(values[name] is not x for name, x in columns.values.items())
    return replace(columns, values=values) if changed else columns


def _on_this_clock(
    columns: LogColumns, channels: Mapping[str, Channel], apart: Sequence[str] = ()
) -> list[str]:
    """Columns of channels on the clock of the log, but for those of some channels."""
    every = dict.fromkeys(c for k, ch in channels.items() if k not in apart for c in ch.columns)
    return [c for c in every if c not in columns.stamps]


def _filled_rows(
    columns: LogColumns, channels: Mapping[str, Channel], name: str
) -> NDArray[np.bool_]:
    """Rows with a number in every wanted cell."""
    wanted = _on_this_clock(columns, channels)
    filled = np.ones(max((len(columns.values[c]) for c in wanted), default=0), dtype=bool)
    for column in wanted:
        bad = ~np.isfinite(columns.values[column])
        if len(bad) and bad.mean() > MOST:
            key = next(k for k, ch in channels.items() if column in ch.columns)
            row = int(np.argmax(bad))
            raise ExperimentError(
                f"{name}: channels.{key.removeprefix('device.')}: column {quote(column)}, "
                f"row {row + 1}: found {columns.values[column][row]:g}, and no number in "
                f"{bad.mean():.0%} of the rows, expected at most {MOST:.0%}; "
                f"{OF_ANOTHER_CLOCK}"
            )
        filled &= ~bad
    return filled


def _rows_without_reading(
    columns: LogColumns,
    channels: Mapping[str, Channel],
    filled: NDArray[np.bool_],
    stamps: Array,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Filled rows for which the logger had no new reading, and those before its source had one."""
    again, between = np.zeros(len(filled), dtype=bool), np.zeros(len(filled), dtype=bool)

    def of(*quantities: str) -> list[Array]:
        some = {k: ch for k, ch in channels.items() if ch.quantity in quantities}
        return [columns.values[c][filled] for c in _on_this_clock(columns, some)]

    every = [columns.values[c][filled] for c in _on_this_clock(columns, channels, APART)]
    if every and filled.any():
        again[filled] = repeated_rows(every, of("position"), of("interaction_force"))
    # a row that repeats another one earlier than that is this row once more
    steps = np.diff(stamps, prepend=stamps[:1])
    again &= steps > HALF * usual_step(steps)
    if len(every) > 1:  # one column alone has the rows of its log
        between[filled] = rows_between_readings(every, of("position"), stamps[filled])
    return again, between


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


def read_at_stamps(
    clock: RecordClock, positions: Sequence[Array], file: str
) -> tuple[bool, list[ReadingStep]]:
    """Whether each row was taken at its stamp, with the reading steps that report it.

    positions: (m,) each, of the clock's rows
    """
    h, rule = clock.sample_time, "positions interpolated, commands held"
    if clock.counted or clock.jitter <= EVEN * h:
        return False, []
    numbers: dict[str, float] = {"rate": 1.0 / h}
    if math.isinf(clock.jitter):
        steps = np.diff(clock.stamps) / h
        numbers |= {"shortest": float(steps.min()), "longest": float(steps.max())}
        between = " to ".join(f"{numbers[key]:.2g}" for key in ("shortest", "longest"))
        text, stamped = f"uneven stamps, steps of {between} times {h:.3g} s", True
        rule = f"each row at its own stamp: {rule}"
    else:
        slope, error = stamps_are_true(clock, positions)
        numbers |= {"jitter": clock.jitter, "followed": slope}
        text = f"stamps {percent(clock.jitter / h, '.2g')} of a row off an even clock"
        share = f"({slope:.2f} +- {error:.1g} of what they say)"
        stamped = slope > HALF and math.isfinite(error)
        rule = f"the position was read at its stamps {share}: {rule}"
        if not stamped:
            rule = f"read on an even clock, for the position does not follow the stamps {share}"
    effect = "none"
    if "followed" in numbers and not abs(slope - 0.5) > SURELY * error:
        effect = "the position hardly tells, so that it makes little difference"
    step = ReadingStep(
        file,
        text,
        rule,
        effect,
        topic="sample clock",
        numbers=tuple(numbers.items()),
        interpolates=stamped,
    )
    return stamped, [step]


def stamps_are_true(clock: RecordClock, positions: Sequence[Array]) -> tuple[float, float]:
    """Whether a position follows uneven stamps (coefficient 1) or an even clock (coefficient 0).

    The deviation of a reading from its neighbours is regressed on the speed times the deviation of
    the stamp from the even clock. Both are second differences, which suppress a smooth motion.

    positions: (m,) each, of the clock's rows
    returns: the coefficient and its standard error; (1, inf) if the positions do not decide
    """
    pairs = [np.zeros((2, 0))]
    off = clock.stamps - clock.time[clock.places]
    for stretch in clock.of_rows:
        place = clock.places[stretch]
        if len(place) < 5:
            continue
        inner = (place[2:] - place[:-2] == 2)[1:-1]
        late = off[stretch] - off[stretch].mean()
        for x in positions:
            x = x[stretch]
            speed = np.zeros(len(x))
            speed[1:-1] = (x[2:] - x[:-2]) / (2.0 * clock.sample_time)
            bend = np.diff(x, 2)[1:-1][inner]
            made = np.diff(speed * late, 2)[1:-1][inner]
            if (squares := float(bend @ bend)) > 0:
                pairs.append(np.stack([bend, made]) * math.sqrt(len(bend) / squares))
    bends, mades = np.concatenate(pairs, axis=1)
    if not (below := float(mades @ mades)) > 0:
        return 1.0, math.inf
    slope = float(mades @ bends) / below
    # neighbouring second differences share readings: six of them count as one
    return slope, math.sqrt(6.0 * float(np.mean((bends - slope * mades) ** 2)) / below)

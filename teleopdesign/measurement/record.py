"""One recording: signals in SI units on a uniform time, and the corrections of its log."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError, did_you_mean, quote
from ..base.files import follow_links
from ..base.frozen import ByValue
from ..base.shown import html_table
from ..base.toml import Table
from .channel import LogLayout
from .doors._log import join_names
from .doors.topics import is_bag
from .log_clock import clock_of_log
from .reading import ReadingStep
from .signals_of_log import signals_of_log
from .stamps import seconds_since_first
from .tables import EXPERIMENT, LogColumns, read_columns, tables_in

#: keys of [[records]] at which "own" gives the record a separate value
SEPARATE = ("position_zero", "bias", "friction_level")


@final
@dataclass(frozen=True, eq=False)
class Record(ByValue):
    """One recording of n samples, for estimation (use "fit") or for errors alone (use "check").

    offset_names: those of "position_zero", "bias" and "friction_level" in which this record may
        differ from the others
    time: s from the first row of the log, shape (n,), uniform within each segment with step
        `sample_time` (s)
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
    begin = float(np.nanmin(since[inside]))
    return LogColumns(values, columns.stamps, columns.notes, begin)


def record_of(columns: LogColumns, name: str, entry: RecordEntry, layout: LogLayout) -> Record:
    """The record from the columns of one log, which are cut to its span.

    name: of the log in messages
    raises ExperimentError: too short, time that does not increase, too many cells without a number
    """
    clock, columns, steps = clock_of_log(columns, layout, name, file=entry.file)
    signals, more = signals_of_log(columns, layout.channels, clock, entry.file)
    return Record(
        entry.file,
        entry.use,
        entry.offset_names,
        clock.time - clock.time[0] + columns.begin,
        clock.sample_time,
        clock.segments,
        signals,
        (*columns.steps(entry.file), *steps, *more),
    )


def record_entries(experiment: Table, folder: Path) -> list[RecordEntry]:
    """(file, use, separate offsets, span) of each [[records]], checked before any file is read."""
    entries: list[RecordEntry] = []
    for table in experiment.tables("records"):
        table.allow(("file", "use", "span", *SEPARATE))
        file, span = table.text("file"), _span(table)
        _check_path(table, folder, file)
        for other, _, _, other_span in entries:
            if file == other and (span is None or other_span is None or overlap(span, other_span)):
                what = (
                    "is listed twice" if span == other_span else "is listed with spans that overlap"
                )
                raise ExperimentError(f"{table.where('file')}: {quote(file)} {what}")
        use = table.choice("use", ("fit", "check"))
        separate = {
            name for name in SEPARATE if table.choice(name, ("common", "own"), "common") == "own"
        }
        entries.append(RecordEntry(file, use, frozenset(separate), span))
    if not any(use == "fit" for _, use, _, _ in entries):
        raise ExperimentError(
            f'{experiment.where("records")}: found {len(entries)} records, none with use = "fit", '
            "expected at least one"
        )
    return entries


def _span(table: Table) -> tuple[float, ...] | None:
    """Read [begin, end] in s from the first row of the log; None: the whole file."""
    if "span" not in table.content:
        return None
    begin, end = table.numbers("span", 2)
    if not 0 <= begin < end:
        raise table.error("span", "[begin, end] in s, from the log's first row")
    return begin, end


def overlap(one: Sequence[float], other: Sequence[float]) -> bool:
    """Whether two spans (begin, end) have a moment in common."""
    return max(one[0], other[0]) < min(one[1], other[1])


def _check_path(table: Table, folder: Path, file: str) -> None:
    where = table.where("file")
    try:
        path = follow_links(folder / file)
        inside = path.is_relative_to(folder)
        exists = path.is_file() or is_bag(path) or path.is_dir() and bool(tables_in(path))
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem)
        raise ExperimentError(f"{where}: {quote(file)} cannot be read: {reason}") from None
    if not inside:
        raise ExperimentError(
            f"{where}: found {quote(file)}, expected a file inside {folder.name}/"
        )
    if not exists:
        names = sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())
        others = [name for name in names if name != EXPERIMENT]
        listed = join_names(others) or "none"
        raise ExperimentError(
            f"{where}: no file {quote(file)}, found {listed}{did_you_mean(file, others)}"
        )

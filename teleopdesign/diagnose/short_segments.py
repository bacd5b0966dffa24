"""Segments of records that are too short to be compared: they do not count, and this is said."""

from __future__ import annotations

from collections.abc import Sequence

from ..measurement.experiment import Experiment
from ..measurement.motion import SHORTEST
from ..measurement.record import Record


def short_segments_line(experiment: Experiment) -> str | None:
    """A sentence where segments of the records are too short to count; else None."""
    parts = [_left_out(record) for record in experiment.records]
    words = [
        f"{short} of {count} in {record.file} ({record.use})"
        for record, (short, count) in zip(experiment.records, parts, strict=True)
        if short
    ]
    if not words:
        return None
    line = (
        f"records: segments shorter than {SHORTEST:g} s do not count, because nothing is left of "
        f"them without their ends: {', '.join(words)}"
    )
    return line + _without_check(experiment.records, parts)


def _left_out(record: Record) -> tuple[int, int]:
    """How many segments of a record are too short, and how many there are."""
    lengths = [(rows.stop - rows.start) * record.sample_time for rows in record.segments]
    return sum(length < SHORTEST for length in lengths), len(lengths)


def _without_check(records: Sequence[Record], parts: Sequence[tuple[int, int]]) -> str:
    """What is done where no segment of any check record counts, as the end of a sentence."""
    check = [p for r, p in zip(records, parts, strict=True) if r.use == "check"]
    if not check or any(short < count for short, count in check):
        return ""
    return (
        ". So no check record counts: the check error is that on blocks that are left out of the "
        "fit in turn"
    )

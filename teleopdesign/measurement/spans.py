"""A part of a log, selected by time: one file can hold the fit record and the check record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..base.errors import ExperimentError
from .channel import Channel, factor_of
from .description import BodyDescription
from .stamps import seconds_since_first
from .tables import LogColumns


def cut_to(
    columns: LogColumns,
    span: Sequence[float],
    channels: Mapping[str, Channel],
    bodies: Mapping[str, BodyDescription],
    sample_rate: float | None,
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
    if sample_rate is None:
        stamps = columns.values[channels["time"].column] * factor_of(
            channels["time"], bodies, "channels.time"
        )
    else:
        count = max(map(len, columns.values.values()))
        stamps = np.arange(count) / sample_rate
    since = seconds_since_first(stamps)
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

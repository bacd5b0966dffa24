"""Windows of long records, spread evenly, on which effects are searched."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .experiment import Experiment
from .record import Record

#: most samples of all records together; if there are more, only windows of the records are used
MOST = 100_000
#: s, length of a window: forty time constants of a 2 Hz low-pass
WINDOW = 4.0


def excerpt(experiment: Experiment, *, most: int = MOST) -> Experiment:
    """The experiment with about `most` samples; the experiment itself where it has no more.

    Nothing is copied: the windows are segments of the records. Hidden states start anew in each
        window.
    """
    total = sum(len(r.time) for r in experiment.records)
    if total <= most:
        return experiment
    part = most / total
    records = tuple(replace(r, segments=_windows(r, part)) for r in experiment.records)
    return replace(experiment, records=records)


def _windows(record: Record, part: float) -> tuple[slice, ...]:
    """Windows that make up about `part` of a record, spread over its segments; at least one.

    The number of windows follows the total length of the segments so far: of many short segments,
    every n-th becomes a window.
    """
    size = max(64, round(WINDOW / record.sample_time))
    windows, owed = [], 0.0
    for segment in record.segments:
        length = segment.stop - segment.start
        owed += part * length / size
        count = round(owed)
        if count * size >= length:
            windows.append(segment)
            owed -= length / size
        elif count:
            places = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])
            starts = [segment.start + int((length - size) * p) for p in places]
            windows += [slice(a, a + size) for a in starts]
            owed -= count
    longest = max(record.segments, key=lambda s: s.stop - s.start)
    return tuple(windows) or (slice(longest.start, min(longest.start + size, longest.stop)),)

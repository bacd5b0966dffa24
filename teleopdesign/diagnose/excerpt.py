"""An excerpt of a long experiment: windows spread evenly over each record, at their own times."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..measurement.experiment import Experiment
from ..measurement.record import Record

#: samples of all records together above which windows are taken
MOST = 100_000
#: s, length of a window: forty time constants of a 2 Hz low-pass
WINDOW = 4.0


def excerpt(experiment: Experiment, *, most: int = MOST) -> Experiment:
    """The experiment with about `most` samples; itself where it is no longer than that.

    Nothing is copied: the windows are segments of the records. Hidden states start anew at each.
    """
    total = sum(len(r.time) for r in experiment.records)
    if total <= most:
        return experiment
    part = most / total
    records = tuple(replace(r, segments=_windows(r, part)) for r in experiment.records)
    return replace(experiment, records=records)


def _windows(record: Record, part: float) -> tuple[slice, ...]:
    """Windows that make up about `part` of every segment, one at least."""
    size = max(64, round(WINDOW / record.sample_time))
    found = []
    for segment in record.segments:
        length = segment.stop - segment.start
        count = max(1, round(part * length / size))
        if count * size >= length:
            found.append(segment)
            continue
        room = length - size
        places = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])
        starts = [segment.start + int(room * p) for p in places]
        found += [slice(a, a + size) for a in starts]
    return tuple(found)

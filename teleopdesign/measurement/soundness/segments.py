"""Gaps: interruptions of a record, and segments that are too short for a comparison."""

from __future__ import annotations

import numpy as np

from ...base.finding import Finding
from ..motion import SHORTEST
from ..record import Record


def check_segments(record: Record) -> list[Finding]:
    """Report interruptions of a record; comparisons leave out segments below `SHORTEST`."""
    h = record.sample_time
    lengths = np.array([(s.stop - s.start) * h for s in record.segments])
    short = lengths < SHORTEST
    if len(lengths) == 1:
        return []
    starts = np.array([record.time[s.start] for s in record.segments])
    ends = np.array([record.time[s.stop - 1] for s in record.segments])
    missing = starts[1:] - ends[:-1] - h
    longest = max(float(missing.max()), 0.0)
    pause = f"the longest gap {longest:.3g} s" if longest > h / 2 else "with no gap between them"
    numbers = {
        "segments": float(len(lengths)),
        "longest_gap": longest,
        "too_short": float(short.sum()),
        "left_out": float(lengths[short].sum()),
    }
    left = (
        f"; {int(short.sum())} of them, {lengths[short].sum():.3g} s in all, are shorter than "
        f"{SHORTEST:g} s and are left out"
        if short.any()
        else ""
    )
    return [
        Finding(
            "gaps",
            "warning" if lengths[short].sum() > 0.1 * lengths.sum() else "note",
            f"{len(lengths)} segments of {lengths.min():.3g} to {lengths.max():.3g} s, {pause}"
            f"{left}. Hidden states start anew at each.",
            numbers,
            record.file,
        )
    ]

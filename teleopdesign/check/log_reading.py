"""How the logs were read: guesses that nobody confirmed, corrections, and interruptions."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Finding
from ..measurement.experiment import Experiment
from ..measurement.limits import SMALL
from ..measurement.motion import SHORTEST
from ..measurement.record import Record
from ..measurement.saving import is_experiment
from ..measurement.spikes import STRONG
from ._recording import CheckedRecording, RecordingCheck


def find_corrections(recording: CheckedRecording) -> Iterator[Finding]:
    """Guesses of `teleopdesign new`, gaps of the records, and corrections of their logs."""
    how = "correct it in experiment.toml, or take its line out of [guessed]"
    if not is_experiment(recording.experiment.folder):
        how = "`units` of td.experiment states it"
    for key, why in recording.experiment.guesses.items():
        yield Finding("guesses", "note", f"{key} was guessed: {why}; {how}.")
    for record in recording.experiment.records:
        yield from check_segments(record)
        for step in record.reading:
            effect = "" if step.effect == "none" else f" ({step.effect})"
            yield Finding(
                step.topic,
                "warning" if step.size > STRONG else "note",
                f"{step.observed}: {step.rule}{effect}.",
                dict(step.numbers),
                record.file,
            )


CHECK = RecordingCheck(order=10, find=find_corrections)


def check_segments(record: Record) -> Iterator[Finding]:
    """Report interruptions of a record; comparisons leave out segments below `SHORTEST`."""
    h = record.sample_time
    lengths = np.array([(s.stop - s.start) * h for s in record.segments])
    short = lengths < SHORTEST
    if len(lengths) == 1 and not short.any():
        return
    starts = np.array([record.time[s.start] for s in record.segments])
    ends = np.array([record.time[s.stop - 1] for s in record.segments])
    longest = float((starts[1:] - ends[:-1] - h).max(initial=0.0))
    pause = f"the longest gap {longest:.3g} s" if longest > h / 2 else "with no gap between them"
    out = float(lengths[short].sum())
    left = (
        f"; {int(short.sum())} of them, {out:.3g} s in all, are shorter than {SHORTEST:g} s and do "
        "not count, because nothing is left of them without their ends"
        if short.any()
        else ""
    )
    yield Finding(
        "gaps",
        "warning" if out > SMALL * lengths.sum() else "note",
        f"{len(lengths)} segments of {lengths.min():.3g} to {lengths.max():.3g} s, {pause}{left}. "
        "Hidden states start anew at each.",
        {
            "segments": float(len(lengths)),
            "longest_gap": longest,
            "too_short": float(short.sum()),
            "left_out": out,
        },
        record.file,
    )


def short_segment_lines(experiment: Experiment) -> list[str]:
    """Lines on the segments of records that do not count; empty where all of them count."""
    gaps = {r.file: f for r in experiment.records for f in check_segments(r)}
    lines = [f"records: {file}: {f.sentence}" for file, f in gaps.items() if f.numbers["too_short"]]
    check = [gaps.get(r.file) for r in experiment.check_records]
    if check and all(f and f.numbers["too_short"] == f.numbers["segments"] for f in check):
        lines.append(
            "records: no check record counts: the check error is that on blocks that are left out "
            "of the fit in turn"
        )
    return lines

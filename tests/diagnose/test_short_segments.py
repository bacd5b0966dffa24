"""Segments that are too short to be compared do not count, and the answer says so."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.check.log_reading import short_segment_lines
from teleopdesign.measurement.prepare import prepare

H = 0.005


def trials(*lengths):
    """Motions under a force, one trial of each length (s), a second apart."""
    begin, parts = 0.0, []
    for k, length in enumerate(lengths):
        t = H * np.arange(round(length / H))
        q, u = np.sin(9.0 * t), 5.0 * np.cos(9.0 * t) - 8.1 * np.sin(9.0 * t)
        parts.append(np.column_stack([np.full(len(t), k), begin + t, q, u]))
        begin += length + 1.0
    return dict(zip(("trial", "t", "q", "u"), np.vstack(parts).T, strict=True))


def experiment(table, **spans):
    return td.experiment(
        table, axis="revolute", inertia=0.1, segment="trial", actuator_force="u",
        position={"column": "q", "unit": "rad"}, **spans,
    )  # fmt: skip


def test_short_segments_are_counted_for_each_record():
    made = experiment(trials(1.5, 0.5, 0.59, 2.0), fit=[(0, 2.2)], check=[(2.2, 9)])
    (line,) = short_segment_lines(made)
    assert line.startswith(f"records: {made.records[1].file}: 3 segments")
    assert "2 of them, 1.09 s in all, are shorter than 0.6 s and do not count" in line
    assert not short_segment_lines(replace(made, records=made.fit_records))


def test_a_refusal_says_that_pauses_cut_the_records():
    """Of a log of 1.2 s with 13 pauses it said "no stretch of 0.6 s or more", and no more."""
    made = experiment(trials(0.5, 0.55), fit=[(0, 9)])
    with pytest.raises(ExperimentError, match="cut them into 2 segments, of which the longest las"):
        prepare(made, bandwidth=5.0)

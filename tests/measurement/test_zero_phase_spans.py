"""The low-pass of signals that are zero but for a few rows: as the low-pass of all rows has it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.zero_phase import filter_both_ways, margin, sections
from teleopdesign.measurement.zero_phase_spans import (
    NEAR,
    connect_spans,
    crossings,
    filter_spans,
    spans_of,
)


def both(signals, rows, cutoff, sample_time):
    """The filtered signals at those rows: of the spans, and of the whole record."""
    n, r = signals.shape
    m = margin(n, sample_time)
    known = sections(cutoff, sample_time)
    whole, spanned = np.empty((n + 2 * m, r)), np.full((n + 2 * m, r), np.nan)
    filter_both_ways(signals, whole, *known)
    spans = spans_of(rows, n, m, cutoff * sample_time)
    filters = (*known, *connect_spans(spans, *crossings(cutoff, sample_time)))
    filter_spans(signals, spanned, spans, filters)
    return spanned[m + rows], whole[m + rows], spans


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    n=st.integers(40, 3_000),
    share=st.sampled_from([0.001, 0.02, 0.3]),
    ends=st.sampled_from([(), (0,), (-1,), (1,), (0, -1), (-2,)]),
    cutoff=st.sampled_from([0.05, 1.0, 5.0, 60.0, 300.0]),
)
def test_the_spans_are_filtered_as_the_whole_record_is(seed, n, share, ends, cutoff):
    rng = np.random.default_rng(seed)
    marked = np.zeros(n, dtype=bool)
    for begin in rng.integers(0, n, max(1, int(share * n / 10))):
        marked[begin : begin + rng.integers(1, 20)] = True
    marked[list(ends)] = True
    rows = np.flatnonzero(marked)
    signals = np.zeros((n, 3))
    signals[rows] = rng.normal(size=(len(rows), 3))
    spanned, whole, _ = both(signals, rows, cutoff, 1e-3)
    # rounding in a filter whose poles lie near one: 1 Hz at 1 kHz multiplies it by thousands
    assert spanned == pytest.approx(whole, rel=0, abs=1e-9 * np.abs(signals).max())


def test_a_long_way_between_two_spans_is_crossed_at_once():
    rows = np.array([500, 501, 90_000])
    signals = np.zeros((100_000, 1))
    signals[rows, 0] = [1.0, -2.0, 3.0]
    spanned, whole, spans = both(signals, rows, 20.0, 1e-3)
    assert spanned == pytest.approx(whole, rel=1e-10)
    assert np.diff(spans).sum() < 20 and len(spans) >= 3


def test_spans_near_each_other_are_one():
    apart = spans_of(np.array([700, 700 + NEAR + 2]), 2_000, 600, 0.1)
    near = spans_of(np.array([700, 700 + NEAR + 1]), 2_000, 600, 0.1)
    assert len(apart) == len(near) + 1


def test_rows_just_inside_the_mirror_images_of_both_ends_change_no_row_of_these():
    """300 samples, continued by 40: rows 1 to 40 and 259 to 298 stand in an image once more."""
    n, m = 300, 40
    for row in (m + 1, n - 2 - m):
        expected = [[0, 1], [m + row, m + row + 1], [n + 2 * m - 1, n + 2 * m]]
        assert spans_of(np.array([row]), n, m, 0.02).tolist() == expected

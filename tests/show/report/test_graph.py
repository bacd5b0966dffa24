"""Graphs of findings, drawn on axes and as elements of a page."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.finding import Series
from teleopdesign.show.figures.graph import thin_series


@given(st.integers(1, 2000), st.integers(2, 300))
def test_a_thinned_series_keeps_its_extremes_and_its_order(n, most):
    y = np.sin(np.arange(n) ** 1.3)
    series = thin_series(Series("a", np.arange(float(n)), y, low=y - 1, high=y + 1), most)
    assert len(series.x) <= max(most, 2)
    assert series.y.min() == y.min() and series.y.max() == y.max()
    assert np.all(np.diff(series.x) > 0)
    assert np.array_equal(series.low, series.y - 1)

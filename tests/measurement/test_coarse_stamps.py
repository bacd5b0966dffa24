"""Stamps that many rows share: whole seconds, dates without fractions, one decimal."""

import numpy as np
import pytest

from teleopdesign.measurement.record_clock import clock_of
from teleopdesign.measurement.stamps import unit_of_steps


def stamps_of(seconds, rate, step, start=0.37, scale=1.0):
    """Stamps (in 1/scale s) rounded down to `step` (s) of rows at `rate` (Hz)."""
    t = start + np.arange(round(seconds * rate)) / rate
    return scale * step * np.floor(t / step + 1e-9)


@pytest.mark.parametrize(("rate", "step"), [(200.0, 1.0), (1000.0, 1.0), (333.0, 0.5), (50, 0.1)])
@pytest.mark.parametrize(("start", "seconds"), [(0.37, 8.3), (0.93, 12.0)])
def test_the_rate_of_the_rows_does_not_depend_on_the_cut_of_a_log(rate, step, start, seconds):
    """Of 200 Hz in whole seconds 211 Hz became: inertia a tenth too small."""
    stamps = stamps_of(seconds, rate, step, start)
    rows = slice(0, len(stamps))
    clock = clock_of(stamps, (rows,), "log")
    assert 1 / clock.sample_time == pytest.approx(rate, rel=2e-3)
    assert np.ptp(clock.time) == pytest.approx((len(stamps) - 1) / rate, rel=2e-3)


@pytest.mark.parametrize(("step", "scale", "unit"), [(1.0, 1.0, "s"), (0.1, 1e3, "ms")])
def test_the_unit_of_stamps_that_rows_share_is_that_of_their_mean_step(step, scale, unit):
    assert unit_of_steps(stamps_of(20, 200, step, scale=scale))[0] == unit

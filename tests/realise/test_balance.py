"""Friction that balances within its bounds: as the same steps give it, each on the whole record."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.signal import sosfilt

from teleopdesign.measurement.zero_phase import sections, zero_phase
from teleopdesign.realise.friction_along import balance_within_bounds
from teleopdesign.realise.traced import constant

SAMPLE_TIME = 2e-3


@pytest.mark.parametrize("rows_of_a_turn", [1, 2])
@pytest.mark.parametrize("bandwidth", [5.0, 20.0])
def test_static_friction_at_few_rows_is_the_best_within_its_bounds(rows_of_a_turn, bandwidth):
    """A low-pass at 5 Hz passes 2 % of one row's change at 500 Hz: plain steps hardly move."""
    rng = np.random.default_rng(11)
    is_open = np.zeros(2_400, dtype=bool)
    for turn in range(300, 2_200, 300):
        is_open[turn : turn + rows_of_a_turn] = True
    low = np.where(is_open, -1.0, np.where(np.arange(2_400) // 300 % 2, 1.0, -1.0))
    high = np.where(is_open, 1.0, low)
    noise = zero_phase(rng.normal(size=2_400), 2.0 * bandwidth, SAMPLE_TIME)
    needed = np.clip(low + 0.1 * noise / noise.std(), -1.05, 1.05)
    signals = [constant(value, 0) for value in (needed, low, high)]
    friction = balance_within_bounds(*signals, bandwidth=bandwidth, sample_time=SAMPLE_TIME).value

    at = np.flatnonzero(is_open)
    one_way = sections(bandwidth, SAMPLE_TIME)[0]
    columns = sosfilt(one_way, np.eye(2_400)[:, at], axis=0)
    others = sosfilt(one_way, np.where(is_open, 0.0, needed - low))
    best = lsq_linear(-columns, -others - columns @ needed[at], bounds=(-1.0, 1.0), tol=1e-14)
    exact = low.copy()
    exact[at] = best.x
    of_filter = (bandwidth, SAMPLE_TIME)
    difference, left = (zero_phase(x, *of_filter) for x in (friction - exact, needed - exact))
    # plain steps leave 0.02 to 0.07
    assert np.linalg.norm(difference) < 0.015 * np.linalg.norm(left)

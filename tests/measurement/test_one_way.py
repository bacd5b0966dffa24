"""A body runs one way if all its returns together are short, whatever its readings scatter."""

import numpy as np
import pytest

from teleopdesign.measurement.reversals import runs_one_way

T = 0.005 * np.arange(4000)
STEP = 1e-4
NOISE = np.random.default_rng(2).standard_normal(len(T))


@pytest.mark.parametrize(
    "path",
    [
        0.2 * T,
        -0.2 * T + 0.02 * NOISE,  # noise of half a percent of the travel
        2.0 * T + 0.05 * np.sin(3.0 * T),  # a speed that changes
        np.minimum(0.2 * T, 3.0) - 0.1 * np.clip(T - 19.0, 0.0, 1.0),  # overshoot at the end
        1.2 * T + 0.201 * np.sin(6.0 * T),  # hardly returns
    ],
)
def test_one_way(path):
    assert runs_one_way(STEP * np.round(path / STEP), STEP)


@pytest.mark.parametrize(
    "path",
    [
        np.sin(1.7 * T),
        1.2 * T + 0.3 * np.sin(6.0 * T),  # 19 returns, each of 0.7 % of the way
        0.003 * NOISE + 1.2 * T + 0.3 * np.sin(6.0 * T),
        np.abs(0.2 * T - 2.0),
    ],
)
def test_both_ways(path):
    assert not runs_one_way(STEP * np.round(path / STEP), STEP)
    assert not runs_one_way(-path, 0.0)

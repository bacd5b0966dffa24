"""Friction that balances within its bounds: as the same steps give it, each on the whole record."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.signal import sosfilt

from teleopdesign.measurement.zero_phase import gains, response, sections, zero_phase
from teleopdesign.realise.friction_along import STEPS, balance_within_bounds
from teleopdesign.realise.traced import Traced, constant

SAMPLE_TIME, BANDWIDTH = 2e-3, 60.0


def step_by_step(needed, low, high):
    """The same accelerated projected steps with every sample filtered in each: slow, and plain."""
    rows = [a.rows() for a in (needed, low, high)]
    is_open = (rows[1] != rows[2]).any(axis=0)
    length = np.ones(len(is_open))
    of_filter = response(BANDWIDTH, SAMPLE_TIME)
    length[is_open] = 1.0 / gains(np.flatnonzero(is_open), len(is_open), of_filter)
    ahead, momentum = np.where(is_open, rows[0], rows[1]), 1.0
    friction = ahead
    for turn in range(STEPS + 1):
        carried = 0.0
        trial = ahead
        if turn > 0:
            left = np.where(is_open, rows[0] - ahead, rows[0] - rows[1])
            trial = ahead + length * zero_phase(left, BANDWIDTH, SAMPLE_TIME)
            later = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * momentum**2))
            carried, momentum = (momentum - 1.0) / later, later
        now = np.where(
            trial[0] >= rows[2][0], rows[2], np.where(trial[0] <= rows[1][0], rows[1], trial)
        )
        now = np.where(is_open, now, rows[1])
        ahead = now + carried * (now - friction) if turn > 0 else now
        friction = now
    return friction


def bounded(seed, open_share, tangents=3, n=2_400):
    rng = np.random.default_rng(seed)
    time = SAMPLE_TIME * np.arange(n)
    needed = Traced(
        np.sin(2 * np.pi * 1.3 * time) + 0.2 * rng.normal(size=n), rng.normal(size=(tangents, n))
    )
    level = Traced(0.6 + 0.1 * np.cos(time), rng.normal(size=(tangents, n)))
    is_open = np.zeros(n, dtype=bool)
    for begin in rng.integers(0, n, 12):
        is_open[begin : begin + int(open_share * n / 12)] = True
    ahead = np.sin(2 * np.pi * 0.7 * time) > 0.0
    low = level.times(np.where(ahead & ~is_open, 1.0, -1.0))
    high = level.times(np.where(ahead | is_open, 1.0, -1.0))
    return needed, low, high


@pytest.mark.parametrize(
    ("seed", "open_share", "n"), [(1, 0.02, 2_400), (2, 0.3, 2_400), (1, 1.5, 2_400)]
)
def test_only_what_changes_is_filtered_and_nothing_else_comes_out(seed, open_share, n):
    signals = bounded(seed, open_share, n=n)
    friction = balance_within_bounds(*signals, bandwidth=BANDWIDTH, sample_time=SAMPLE_TIME)
    # rounding, through eight turns of a filter that amplifies nothing
    assert friction.rows() == pytest.approx(step_by_step(*signals), abs=1e-10)


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

"""Noise, steps and jitter of readings that were made so."""

import numpy as np
import pytest

from teleopdesign.measurement.encoder import (
    grid_of,
    reading_noise,
    reading_step,
    sampling_jitter,
    update_period,
)

H = 0.002
T = H * np.arange(6000)
SWING = np.sin(2 * np.pi * 0.6 * T) + 0.4 * np.sin(2 * np.pi * 1.7 * T + 1.0)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e3])
def test_the_noise_of_readings_is_distinguished_from_their_motion(size):
    rng = np.random.default_rng(0)
    noise = size * rng.standard_normal(len(T))
    assert reading_noise(noise) == pytest.approx(size, rel=0.05)
    assert reading_noise(noise + 100 * size * SWING) == pytest.approx(size, rel=0.05)
    # a few kicks change nothing
    noise[::500] += 100 * size
    assert reading_noise(noise) == pytest.approx(size, rel=0.1)


@pytest.mark.parametrize("step", [1e-4, 2 * np.pi / 4096, 0.01])
def test_the_step_of_an_encoder_is_read_off_its_values(step):
    read = step * np.round(SWING / step)
    assert reading_step(read) == pytest.approx(step, rel=0.02)
    assert grid_of(read, reading_step(read)) == pytest.approx(step, rel=1e-5)
    # as a log of few digits has them, and by an estimate that is a little off: from end to end
    # digits that were cut off average out
    cut = np.round(read, 6)
    assert grid_of(cut, 1.004 * step) == pytest.approx(step, rel=1e-6)


def test_readings_on_no_grid_have_none():
    rng = np.random.default_rng(1)
    assert grid_of(SWING + 1e-3 * rng.standard_normal(len(T)), 1e-3) == 0.0
    assert grid_of(SWING, 0.0) == 0.0 and grid_of(SWING, 0.5) == 0.0
    assert reading_step(np.ones(100)) == 0.0
    # of a motion that never comes back, no more than the rounding that its noise looks like
    once = np.linspace(0.0, 1.0, 3000) ** 1.3
    with_noise = once + 1e-6 * rng.standard_normal(3000)
    assert reading_step(with_noise) == pytest.approx(1e-6 * 12**0.5, rel=0.1)


@pytest.mark.parametrize("jitter", [2e-5, 1e-4, 5e-4])
@pytest.mark.parametrize("size", [1.0, 1e-3])
def test_the_jitter_of_a_clock_is_read_off_what_scatters_with_speed(jitter, size):
    rng = np.random.default_rng(2)
    fast = lambda t: size * np.sin(2 * np.pi * 2.0 * t)  # noqa: E731
    read = fast(T + jitter * rng.standard_normal(len(T)))
    assert sampling_jitter(read, 0.0, H) == pytest.approx(jitter, rel=0.1)
    coarse = 8e-4 * size  # the rounding of an encoder beside it
    assert sampling_jitter(coarse * np.round(read / coarse), coarse, H) == pytest.approx(
        jitter if jitter > 5e-5 else 0.0, rel=0.3
    )
    even = fast(T)
    noise = 1e-3 * size * rng.standard_normal(len(T))
    assert sampling_jitter(even + noise, 0.0, H) == 0.0, "noise is the same at any speed"
    step = 1e-4 * size
    assert sampling_jitter(step * np.round(even / step), step, H) == 0.0
    assert sampling_jitter(read[:400], 0.0, H) == 0.0, "too short to tell"


def test_of_readings_that_are_held_one_each_counts():
    """A reading that comes in each fifth row jitters by a part of its own period."""
    rng = np.random.default_rng(6)
    when = 5 * H * np.arange(3000)
    late = 2e-4 * rng.standard_normal(3000)
    read = np.sin(2 * np.pi * 0.3 * (when + late)) * (1 + 0.8 * np.sin(0.2 * when))
    assert update_period(np.repeat(read, 5)) == 5 and update_period(read) == 1
    jitter = sampling_jitter(read, 0.0, 5 * H)
    assert jitter == pytest.approx(2e-4, rel=0.3)
    assert sampling_jitter(np.repeat(read, 5), 0.0, H) == pytest.approx(jitter, rel=1e-9)

"""Low-pass, derivatives, hold; what readings tell of a motion."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.encoder import grid_of
from teleopdesign.measurement.motion import (
    TRAVEL,
    direction_of,
    motion_of,
    reading_step,
)

RATE = 1000.0
T = np.arange(4000) / RATE
INSIDE = slice(700, -700)  # the ends feel how the record is continued


# direction

STEP = 1e-5
PATIENCE = 20


def direction_from(position):
    return direction_of(position, STEP, STEP, PATIENCE)


def read(position):
    return STEP * np.round(position / STEP)


def test_an_encoder_that_dithers_between_two_steps_tells_no_motion():
    rng = np.random.default_rng(0)
    assert not direction_from(STEP * rng.integers(0, 2, 500).astype(float)).any()


def test_a_creep_slower_than_the_patience_tells_no_motion():
    slow = read(np.arange(2000) * STEP / (2 * PATIENCE))
    assert not direction_from(slow).any()


def test_a_motion_is_known_from_its_first_step_to_its_last():
    x = read(np.concatenate([np.zeros(100), np.arange(200) * 2 * STEP, np.full(100, 400 * STEP)]))
    direction = direction_from(x)
    assert np.all(direction[102:299] == 1)
    assert not direction[:100].any() and not direction[301:].any()
    np.testing.assert_array_equal(direction_from(-x), -direction)


def test_a_give_of_less_than_the_travel_tells_no_motion():
    x = read(np.concatenate([np.zeros(50), np.linspace(0, (TRAVEL - 1) * STEP, 20), np.zeros(50)]))
    assert not direction_from(x).any()


@settings(max_examples=60)
@given(seed=st.integers(0, 2**31), speed=st.floats(0.01, 30.0))
def test_the_direction_never_contradicts_the_readings(seed, speed):
    """Every change of the reading within a told motion goes the told way."""
    rng = np.random.default_rng(seed)
    legs = np.repeat(rng.normal(size=60) * speed * STEP, rng.integers(1, 40, 60))
    x = read(np.cumsum(legs))
    direction = direction_from(x)
    assert set(np.unique(direction)) <= {-1, 0, 1}
    change = np.diff(x)
    inside = (direction[1:] != 0) & (direction[:-1] == direction[1:])
    assert np.all(change[inside] * direction[1:][inside] >= 0)
    # what is told covers the least travel, from before its first change to its last
    edges = np.flatnonzero(np.diff(direction, prepend=0))
    for start, end in zip(edges, [*edges, len(x) - 1][1:], strict=False):
        if direction[start]:
            assert abs(x[end] - x[start - 1]) > (TRAVEL - 0.6) * STEP


@pytest.mark.parametrize("digits", [6, 9, 15])
@pytest.mark.parametrize("turns", [0.3, 1.1])
def test_the_step_of_an_encoder_is_estimated_though_the_body_rests_half_the_time(turns, digits):
    """Most fourth differences are then those of printed digits: no noise is seen, but a grid."""
    step, t = 2 * np.pi / 32768, np.arange(10_000) / 1000
    stop_and_go = np.clip(2.5 * np.sin(2 * np.pi * 0.4 * t), -1, 1) + 0.02 * t
    written = np.round(step * np.round(2 * np.pi * turns * stop_and_go / step), digits)
    assert grid_of(written, reading_step(written)) == pytest.approx(step, rel=1e-6)
    assert reading_step(written) == pytest.approx(step, abs=2.1 * 10.0**-digits)


@pytest.mark.parametrize("ripple", [0.0, 1e-5, 1e-4])
def test_the_way_of_a_sample_is_no_encoders_step_where_a_body_moves_evenly(ripple):
    """At a constant speed readings lie on a grid too, each place of it read once."""
    noise = 3e-5 * np.random.default_rng(4).standard_normal(120)
    even = 2.6e-3 * np.arange(120) + ripple * np.sin(0.3 * np.arange(120)) + noise
    assert reading_step(even) < 5e-4


@pytest.mark.parametrize("digits", [9, 15])
def test_a_motion_without_an_encoder_has_no_grid(digits):
    t = np.arange(10_000) / 1000
    smooth = np.round(3 * np.sin(2 * np.pi * 0.4 * t) + np.sin(2 * np.pi * 1.3 * t), digits)
    assert grid_of(smooth, float(np.quantile(np.diff(np.unique(smooth)), 0.002))) == 0.0
    assert grid_of(smooth, reading_step(smooth)) == 0.0


# motion


def motion(position, *, bandwidth=60.0, resolution=None):
    return motion_of(
        body="device",
        file="made",
        time=T,
        position=position,
        command=np.zeros(len(T)),
        interaction=None,
        sample_time=1 / RATE,
        rows=slice(0, len(T)),
        bandwidth=bandwidth,
        resolution=resolution,
    )


def test_a_motion_within_the_band_keeps_position_velocity_and_acceleration():
    w = 2 * np.pi * 20
    m = motion(read(0.01 * np.sin(w * T)), resolution=STEP)
    quantities = ((m.position, 0.01 * np.sin(w * T)), (m.velocity, 0.01 * w * np.cos(w * T)))
    for k, (signal, expected) in enumerate(quantities):
        # what an encoder step of 1e-3 of the amplitude leaves of its own, 0.3 of a step rms
        size = np.abs(expected).max()
        assert np.std((signal - expected)[INSIDE]) < (2e-4 + 1e-3 * k) * size


def test_noisy_readings_tell_the_motion_that_clean_ones_tell():
    rng = np.random.default_rng(2)
    x = 0.01 * np.sin(2 * np.pi * 2 * T)
    m = motion(x + 5e-6 * rng.standard_normal(len(T)), resolution=1e-7)
    moving = np.abs(np.cos(2 * np.pi * 2 * T)) > 0.2
    speed = np.sign(np.cos(2 * np.pi * 2 * T))
    assert m.step > 1e-5, "the noise is what one reading leaves open"
    assert np.mean(m.direction[moving] == speed[moving]) > 0.97
    assert not np.any(m.direction[moving] == -speed[moving])

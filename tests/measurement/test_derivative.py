"""At which period a column wraps, and which is the derivative of which."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.survey.derivative import (
    derivative_factor,
    follows_direction,
    rate_agreement,
    unwrap_column,
    wrap_of,
)

H = 0.005
T = H * np.arange(4000)
SWING = np.sin(2 * np.pi * 0.6 * T) + 0.4 * np.sin(2 * np.pi * 1.7 * T + 1.0)


def rate_of(x, order=1):
    return np.gradient(x, H) if order == 1 else rate_of(np.gradient(x, H))


PERIODS = [360.0, 2 * math.pi, 1.0, 400.0, 180.0, math.pi, 256.0, 4096.0, 65536.0, 2.0**32]


@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("direction", [1, -1])
def test_a_column_that_turns_on_wraps_at_a_turn_or_at_a_power_of_two(period, direction):
    whole = direction * period * (0.4 * T + 0.1 * SWING)
    wrapped = np.mod(whole, period)
    assert wrap_of(wrapped) == pytest.approx(period)
    assert np.ptp(unwrap_column(wrapped, wrap_of(wrapped)) - whole) < 1e-9 * period
    centred = np.mod(whole + 0.5 * period, period) - 0.5 * period
    assert wrap_of(centred) == pytest.approx(period)


@pytest.mark.parametrize("period", [300.0, 7.0, 1.3, 1000.0, 4200.0])
def test_no_column_wraps_at_any_other_length(period):
    assert wrap_of(np.mod(period * (0.4 * T + 0.1 * SWING), period)) is None


@pytest.mark.parametrize("lines", [500, 1000, 1024, 1250, 2000, 2048, 2500, 4096])
@pytest.mark.parametrize("per_line", [1, 2, 4])
def test_an_encoder_of_four_thousand_counts_is_not_read_as_one_of_4096(lines, per_line):
    """Each turn would end by a jump of 96 counts."""
    counts = lines * per_line
    wrapped = np.mod(np.round(counts * (0.4 * T + 0.1 * SWING)), counts)
    known = counts in {m * 10**k for m in (1, 2, 4, 5, 8) for k in (2, 3, 4)} | {
        2**k for k in range(9, 20)
    }
    assert wrap_of(wrapped) == (counts if known else None)


@pytest.mark.parametrize("rows_a_turn", [25, 60, 400])
@pytest.mark.parametrize("period", [360.0, 2 * math.pi, 4000.0, 4096.0])
def test_a_fast_turn_wraps_where_a_slow_one_does(rows_a_turn, period):
    """From one row to the next a part of the turn is covered that no jump shows."""
    turns = np.arange(1000) / rows_a_turn
    turns += 0.02 * np.sin(turns)
    for way in (1, -1):
        wrapped = np.mod(way * np.round(period * turns, 0 if period > 1000 else 6), period)
        assert wrap_of(wrapped) == pytest.approx(period)


def test_a_place_that_trembles_at_the_wrap_wraps_there():
    there = np.r_[np.linspace(-60.0, -0.5, 500), 0.3, -0.3, 0.3, -0.3, np.linspace(0.5, 60.0, 500)]
    assert wrap_of(np.mod(there, 360.0)) == 360.0


def test_a_column_that_swings_steps_or_rests_does_not_wrap():
    for x in (SWING, 360.0 * T, np.ones(400), np.sign(SWING), np.floor(4 * SWING)):
        assert wrap_of(x) is None
        assert unwrap_column(x, None) is x


@given(factor=st.floats(0.01, 100.0), sign=st.sampled_from([1, -1]), offset=st.floats(-5, 5))
@settings(max_examples=20)
def test_a_velocity_in_any_unit_is_a_factor_times_the_derivative(factor, sign, offset):
    v = sign * factor * (rate_of(SWING) + offset)
    estimate, alike = derivative_factor(3.0 + SWING, v, H)
    assert estimate == pytest.approx(sign * factor, rel=1e-3)
    assert alike == pytest.approx(sign, abs=1e-4)


def test_noise_above_the_motion_does_not_hide_a_derivative():
    noise = 5.0 * np.cos(2 * np.pi * 60.0 * T)
    factor, alike = derivative_factor(SWING, rate_of(SWING) + noise, H)
    assert factor == pytest.approx(1.0, abs=0.01) and alike > 0.999


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_friction_follows_the_direction_and_a_tachometer_the_speed(sign, size):
    rate = rate_of(SWING)
    assert follows_direction(SWING, size * np.sign(rate), H)
    assert not follows_direction(SWING, size * rate, H)
    mixed = [follows_direction(SWING, size * (np.sign(rate) + k * rate), H) for k in (0.05, 5.0)]
    assert mixed == [True, False]


def test_dry_friction_beside_a_large_force_is_no_velocity():
    """It follows the direction of a motion at constant speed, but it does not change its sign."""
    h, rows = 0.01, 600
    x = 30.0 * np.abs(h * np.arange(rows) % 4.0 / 2.0 - 1.0)
    friction = 9.0 * np.sign(np.gradient(x))
    assert rate_agreement(x, friction + 100.0, h) == 0.0
    assert rate_agreement(x, friction, h) > 0.9

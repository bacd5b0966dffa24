"""Columns of a log by hand: at which period they wrap, what is whose derivative, what turns."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.filtering import spectrum
from teleopdesign.measurement.first_guess import (
    balance_factor,
    explain_force,
    explain_forces,
    is_turned,
    motion_columns,
)
from teleopdesign.measurement.survey.derivative import (
    derivative_factor,
    follows_direction,
    unwrap_column,
    wrap_of,
)

H = 0.005
T = H * np.arange(4000)
SWING = np.sin(2 * np.pi * 0.6 * T) + 0.4 * np.sin(2 * np.pi * 1.7 * T + 1.0)


def rate_of(x, order=1):
    return np.gradient(x, H) if order == 1 else rate_of(np.gradient(x, H))


# wraps

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


def test_jumps_of_two_lengths_are_no_wrap():
    x = np.mod(360.0 * 0.4 * T, 360.0)
    x[2000:] *= 0.8
    assert wrap_of(x) is None


# derivatives


@given(factor=st.floats(0.01, 100.0), sign=st.sampled_from([1, -1]), offset=st.floats(-5, 5))
@settings(max_examples=20)
def test_a_velocity_in_any_unit_is_a_factor_times_the_derivative(factor, sign, offset):
    v = sign * factor * (rate_of(SWING) + offset)
    found, alike = derivative_factor(3.0 + SWING, v, H)
    assert found == pytest.approx(sign * factor, rel=1e-3)
    assert alike == pytest.approx(sign, abs=1e-4)


def test_how_much_a_column_is_the_derivative_is_its_correlation():
    rate = rate_of(SWING)
    other = np.cos(2 * np.pi * 0.97 * T)
    other -= (other @ rate) / (rate @ rate) * rate
    other *= np.linalg.norm(rate) / np.linalg.norm(other)
    factor, alike = derivative_factor(SWING, rate + other, H)
    assert factor == pytest.approx(1.0, abs=0.02) and alike == pytest.approx(2**-0.5, abs=0.02)
    assert abs(derivative_factor(SWING, other, H)[1]) < 0.03
    assert abs(derivative_factor(SWING, SWING, H)[1]) < 0.1, "a place is not its own rate"
    # of what stands still nothing is the rate
    assert abs(derivative_factor(np.ones(4000), rate, H)[1]) < 0.1
    assert abs(derivative_factor(SWING, np.ones(4000), H)[1]) < 0.1
    assert derivative_factor(np.zeros(4000), rate, H) == (0.0, 0.0)
    assert derivative_factor(SWING, np.zeros(4000), H) == (0.0, 0.0)


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


def test_the_columns_of_a_motion_are_its_rates_and_its_direction():
    v, a, direction = motion_columns(SWING, H)
    inner = slice(300, -300)
    assert v[inner] == pytest.approx(rate_of(SWING)[inner], abs=0.02)
    assert a[inner] == pytest.approx(rate_of(SWING, 2)[inner], abs=0.5)
    # low-passed at 4 Hz, a fiftieth of the rows: the direction is whole away from its turns
    away = np.abs(v[inner]) > 0.5 * np.abs(v).max()
    assert direction[inner][away] == pytest.approx(np.sign(v[inner])[away], abs=0.3)
    for none in motion_columns(np.ones(400), H):
        assert np.abs(none).max() < 1e-9


# first values


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("inertia", "level", "damping"),
    [(0.2, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.8), (0.2, 1.0, 0.5), (0.01, 1.0, 0.0)],
)
def test_a_force_that_would_drive_by_friction_or_inertia_is_turned(turned, inertia, level, damping):
    v = rate_of(SWING)
    force = inertia * rate_of(SWING, 2) + level * np.sign(v) + damping * v + 0.7
    assert is_turned(-force if turned else force, SWING, H) == turned
    assert is_turned(force, -SWING if turned else SWING, H) == turned


def test_what_makes_more_of_the_force_decides():
    """A little inertia of the wrong sign is what is late in slow motion; much of it is no such."""
    v, a = rate_of(SWING), rate_of(SWING, 2)
    assert not is_turned(1.0 * np.sign(v) - 0.002 * a, SWING, H)
    assert is_turned(0.1 * np.sign(v) - 0.2 * a, SWING, H)


def test_of_noise_rest_and_short_records_nothing_is_turned():
    noise = np.random.default_rng(0).standard_normal(len(T))
    assert not is_turned(noise, SWING, H) and not is_turned(-noise, SWING, H)
    assert not is_turned(noise, np.zeros(len(T)), H)
    assert not is_turned(-rate_of(SWING)[:150], SWING[:150], H)


def test_a_motion_in_one_direction_tells_a_constant_force_from_no_friction():
    """Only its inertia is told, and only if that is surely of one sign."""
    x = 10.0 * T + 0.2 * SWING
    a = rate_of(x, 2)
    assert not is_turned(0.1 * a - 3.0, x, H)
    assert is_turned(-0.1 * a + 3.0, x, H)


@pytest.mark.parametrize("factor", [0.3, 1.0, -2.0])
def test_the_force_that_balances_is_found_whatever_the_body_is(factor):
    rng = np.random.default_rng(4)
    hand = np.convolve(rng.standard_normal(len(T)), np.hanning(80), "same")
    v, a = rate_of(SWING), rate_of(SWING, 2)
    force = 0.1 * a + 0.5 * np.sign(v) + 0.2 * v + 0.3 - factor * hand
    found, error = balance_factor(force, hand, SWING, H)
    assert found == pytest.approx(factor, abs=0.03) and 0 < error < 0.05
    assert balance_factor(force[:150], hand[:150], SWING[:150], H) == (0.0, np.inf)
    # while the body rests friction takes any force: these rows do not count
    still = np.where(T < 10.0, SWING, SWING[2000])
    held = np.where(T < 10.0, force, 5.0 * rng.standard_normal(len(T)))
    assert balance_factor(held, hand, still, H)[0] == pytest.approx(factor, abs=0.1)


def test_the_explained_part_is_that_of_the_squares_about_the_mean():
    v, a = rate_of(SWING), rate_of(SWING, 2)
    made = 0.1 * a + 0.5 * v
    apart = np.cos(2 * np.pi * 1.13 * T)
    apart *= np.std(made) / np.std(apart)
    guess = explain_force(made + apart + 100.0, SWING, H)
    assert guess.explained == pytest.approx(0.5, abs=0.03)
    assert guess.left == pytest.approx(np.std(apart), rel=0.05)
    assert explain_force(np.full(len(T), 3.0), SWING, H).explained == pytest.approx(0.0, abs=1e-6)
    nothing = explain_forces([], H)
    assert nothing.explained == 0.0 and np.isinf(nothing.errors).all()


def test_errors_of_first_values_count_each_second_as_one_reading():
    """Over draws of noise of a second's correlation the values scatter by them."""
    rng, off = np.random.default_rng(1), []
    v, a = rate_of(SWING), rate_of(SWING, 2)
    made = 0.1 * a + 0.5 * np.sign(v) + 0.2 * v
    for _ in range(12):
        noise = np.repeat(rng.standard_normal(20), 200)
        guess = explain_force(made + noise, SWING, H)
        wrong = np.array([guess.inertia - 0.1, guess.level - 0.5, guess.damping - 0.2])
        off.append(wrong / np.array(guess.errors))
    assert 0.1 < np.sqrt(np.mean(np.square(off))) < 2.0


# filters at the ends of a record


@given(
    n=st.integers(2, 500),
    level=st.floats(-10, 10),
    slope=st.floats(-10, 10),
    cutoff=st.floats(1.0, 90.0),
)
@settings(max_examples=40)
def test_a_line_is_a_line_behind_the_low_pass_inside_and_one_of_less_at_no_end(
    n, level, slope, cutoff
):
    """Level and slope go on beyond both ends: nothing rings there."""
    line = level + slope * H * np.arange(n)
    grid = spectrum(n, H)
    left = grid.multiply(line, np.ones(len(grid.frequency))) - line
    assert np.abs(left).max() < 1e-9
    assert len(grid.frequency) == grid.length // 2 + 1
    if n > 400:
        low = grid.multiply(line, grid.lowpass(cutoff))
        inner = slice(n // 3, -n // 3)
        # what closes the circle far away leaves a little of itself
        assert np.abs(low - line)[inner].max() < 0.02 * (abs(slope) * H * n + 1e-9) + 1e-9


def test_a_record_is_continued_oddly_for_six_tenths_of_a_second():
    rng = np.random.default_rng(0)
    for n, margin in [(1000, 120), (100, 99), (121, 120), (2, 1)]:
        y = rng.standard_normal(n)
        grid = spectrum(n, H)
        assert grid.margin == margin
        whole = np.fft.irfft(grid.transform(y), grid.length)
        m = margin
        assert whole[m : m + n] == pytest.approx(y)
        for k in range(1, m + 1):
            assert whole[m - k] == pytest.approx(2 * y[0] - y[k])
            assert whole[m + n - 1 + k] == pytest.approx(2 * y[-1] - y[-1 - k])
        # beyond, a bridge leads back without a step: monotonously from one end to the other
        bridge = np.r_[whole[m + n + m - 1 :], whole[0]]
        steps = np.diff(bridge) * np.sign(bridge[-1] - bridge[0])
        assert (steps >= -1e-9).all()
        assert len(bridge) >= 2 * m
        if m > 50:
            assert max(steps[0], steps[-1]) < 0.1 * steps.max(), "it sets off and ends level"


@pytest.mark.parametrize("cutoff", [5.0, 40.0, 99.0])
@pytest.mark.parametrize("order", [2, 4, 8])
def test_a_low_pass_leaves_half_at_its_cutoff_and_nothing_at_the_end_of_the_band(cutoff, order):
    grid = spectrum(4000, H)
    gain = grid.lowpass(cutoff, order=order)
    assert gain[0] == 1.0 and np.all(np.diff(gain) <= 0)
    assert np.interp(cutoff, grid.frequency, gain) == pytest.approx(0.5, abs=0.02)
    assert gain[-1] < 1e-6 or cutoff > 98.0
    wide = grid.lowpass(1e4)
    assert wide[: len(wide) // 2].min() > 0.999


def test_a_signal_is_read_later_by_moving_what_is_to_come_forward():
    grid = spectrum(4000, H)
    inner = slice(400, -400)
    for time in (0.003, -0.02):
        moved = grid.multiply(SWING, grid.ahead(time))
        later = np.sin(2 * np.pi * 0.6 * (T + time)) + 0.4 * np.sin(
            2 * np.pi * 1.7 * (T + time) + 1.0
        )
        assert moved[inner] == pytest.approx(later[inner], abs=1e-3)

"""A sensor slower than its log: readings that are held until the next one are no motion."""

from dataclasses import replace

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.fitted_checks import check_experiment
from teleopdesign.measurement.bandwidth import INTERPOLATED, bandwidth_of
from teleopdesign.measurement.resample import interpolate_by_rule

RATE, STEP = 1000.0, 1e-6
T = np.arange(8000) / RATE
ANGLE = 0.3 * np.sin(2 * np.pi * 0.9 * T) + 0.1 * np.sin(2 * np.pi * 2.3 * T)
PUSH = 0.4 * np.sin(2 * np.pi * 1.7 * T)
COMMAND = np.sin(2 * np.pi * 3.1 * T)


def held(y, every):
    """The values of which only one in `every` rows is a new reading."""
    return y[np.arange(len(y)) // every * every]


def record(angle=1, push=1, command=1, pause=False):
    """The record of a log; arguments: rows for which each channel holds a reading.

    pause: whether the body rests for two seconds
    """
    rest = np.minimum(np.maximum(T - 3.0, 0.0), 2.0) if pause else 0.0
    steps = np.round(RATE * (T - rest)).astype(int)
    noise = 1e-3 * np.random.default_rng(0).standard_normal(len(T))
    table = {
        "t": T,
        "q": held(STEP * np.round(ANGLE[steps] / STEP), angle),
        "push": held(PUSH + noise, push),
        "u": held(COMMAND, command),
    }
    return td.experiment(
        table,
        axis="revolute",
        inertia=0.02,
        position={"column": "q", "unit": "rad", "resolution": STEP},
        interaction_force="push",
        actuator_force="u",
    )


@pytest.mark.parametrize(("every", "pause"), [(2, False), (8, True)])
def test_a_position_is_read_at_its_readings_and_between_them(every, pause):
    slow = record(angle=every, pause=pause)
    error = (
        slow.records[0].signals["device.position"]
        - record(pause=pause).records[0].signals["device.position"]
    )
    moved = np.abs(held(ANGLE, every) - ANGLE).max()
    assert np.abs(error[every:-every]).max() < 0.1 * moved
    assert slow.records[0].rate_of("device.position") == pytest.approx(RATE / every, rel=1e-3)
    assert not [f for f in check_experiment(slow) if f.topic == "held samples"]


def test_a_force_sensor_is_read_at_its_readings_and_a_command_is_held():
    slow = record(push=8, command=8).records[0]
    error = slow.signals["device.interaction_force"] - PUSH
    assert np.abs(error[8:-8]).max() < 0.3 * np.abs(held(PUSH, 8) - PUSH).max()
    np.testing.assert_allclose(slow.signals["device.actuator_force"], held(COMMAND, 8))


def test_a_log_without_slower_sensors_is_as_it_was():
    fast = record().records[0]
    np.testing.assert_array_equal(fast.signals["device.position"], STEP * np.round(ANGLE / STEP))
    assert not fast.reading


def test_a_comparison_ends_where_the_readings_of_a_slower_sensor_end():
    slow, fast = (replace(record(push=n), bandwidth=50.0) for n in (8, 1))
    assert bandwidth_of(slow) == pytest.approx(INTERPOLATED * RATE / 8, rel=1e-3)
    assert bandwidth_of(fast) == 50.0
    assert bandwidth_of(replace(slow, bandwidth=5.0)) == 5.0


def test_a_motion_that_turns_between_two_readings_of_a_coarse_encoder_bends():
    grid, step = np.arange(2000.0), 1e-3
    place = 0.05 * np.sin(2 * np.pi * grid / 64.0)
    read = step * np.round(place / step)
    at = grid[::8]
    between = interpolate_by_rule(read[::8], at, grid, "position", step=step, slower_clock=True)
    inner = slice(16, -16)
    assert np.abs(between - place)[inner].max() < 1.5 * step

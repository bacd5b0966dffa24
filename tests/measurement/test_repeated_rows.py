"""Rows that say what the row before says are lost ones, where a channel tells; a rest is none."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.measurement.repeated_rows import (
    LASTING,
    repeated_rows,
    rows_between_readings,
    runs_of,
)

ROWS = 2000


def moved(seed=0, noise=0.01):
    """Position by an encoder with rests, a command in steps, a force with noise."""
    rng = np.random.default_rng(seed)
    t = np.arange(ROWS) / 500
    x = np.round(np.clip(np.sin(5 * t), -0.8, 0.8) / 1e-3) * 1e-3
    return t, x, np.round(np.sin(3 * t), 1), np.cos(5 * t) + noise * rng.standard_normal(ROWS)


def spoilt(columns, again):
    """Each of these rows is the one before it, under its own time."""
    t, *rest = (y.copy() for y in columns)
    for row in np.flatnonzero(again):
        for y in rest:
            y[row] = y[row - 1]
    return t, *rest


@given(st.lists(st.integers(10, ROWS - 20), min_size=1, max_size=60), st.integers(0, 5))
def test_exactly_the_rows_that_repeat_are_lost(rows, seed):
    again = np.zeros(ROWS, dtype=bool)
    again[rows] = True
    _, *columns = spoilt(moved(seed), again)
    first, past = runs_of(again)
    if (past - first).max() < LASTING:
        np.testing.assert_array_equal(repeated_rows(columns, columns[:1], columns[2:]), again)


def test_a_rest_is_no_repeat():
    t, x, u, f = moved()
    assert not repeated_rows([x, u, f], [x], [f]).any()
    x, u, f = (np.where((t > 1) & (t < 2), y[500], y) for y in (x, u, f))  # a still simulation
    assert not repeated_rows([x, u, f], [x], [f]).any()


def test_a_moving_position_that_stops_for_a_row_tells_of_a_lost_row_without_a_force():
    t, again = np.arange(ROWS) / 500, np.zeros(ROWS, dtype=bool)
    again[[300, 700, 1130]] = True
    _, x, u = spoilt((t, np.round(np.sin(5 * t), 6), np.sin(3 * t)), again)
    np.testing.assert_array_equal(repeated_rows([x, u], [x]), again)


def test_a_motion_without_noise_that_stops_for_a_while_has_lost_nothing():
    t = np.arange(ROWS) / 500
    way = np.clip(t, 0, 1) + np.clip(t - 2, 0, 1)  # goes, rests for a second, goes on
    smooth = way - np.sin(2 * np.pi * way) / (2 * np.pi)
    force = np.where(way % 1 > 0, np.sin(2 * np.pi * way), 0.0)
    assert not repeated_rows([smooth, force, 3 * force], [smooth], [force]).any()


@pytest.mark.parametrize("with_time", [True, False])
def test_a_record_with_repeated_rows_is_that_of_lost_rows(with_time):
    again = np.zeros(ROWS, dtype=bool)
    again[300:1700:50] = True
    clean, columns = moved(), spoilt(moved(), again)

    data = dict(zip(("t", "x", "u", "f"), columns, strict=True))
    units = {"t": "s", "x": "m", "u": "N", "f": "N"}
    if with_time:
        more = {"time": "t"}
    else:
        more = {"sample_rate": 500.0}
        del data["t"], units["t"]
    experiment = td.experiment(
        data, axis="prismatic", position="x", actuator_force="u", interaction_force="f",
        units=units, inertia=0.2, **more,
    )  # fmt: skip
    one = experiment.fit_records[0]
    off = one.signals["device.position"] - clean[1][: len(one.time)]
    assert np.abs(off).max() < 2.5e-3  # two steps
    assert any("the same as the one before" in step.observed for step in one.reading)


def polled(period, poll, *, jitter=0.0, time=8.0):
    """Stamps, position and force of a script that writes what its source said last."""
    rng = np.random.default_rng(4)
    stamps = np.arange(0.0, time, poll)
    stamps = stamps + jitter * poll * rng.random(len(stamps))
    at = np.floor(stamps / period + 1e-9) * period
    # it moves, and rests for a second
    moved = np.where(np.abs(at - 4.0) < 0.5, 0.0, np.sin(5 * at) * np.cos(1.7 * at))
    return stamps, np.round(moved / 1e-4) * 1e-4, np.round((moved + 0.2 * np.cos(31 * at)) / 1e-3)


@pytest.mark.parametrize("jitter", [0.0, 0.4])
@pytest.mark.parametrize("times", [2.0, 4.0, 3.7])
def test_of_rows_that_come_faster_than_readings_one_of_each_stays(times, jitter):
    stamps, x, u = polled(0.002 * times, 0.002, jitter=jitter)
    kept = ~rows_between_readings([x, u], [x], stamps)
    assert kept.sum() == pytest.approx(8.0 / (0.002 * times), rel=0.03)
    assert np.diff(stamps[kept]).max() < 1.7 * 0.002 * times, "rests keep their rows"
    changes = np.flatnonzero((np.diff(x) != 0) | (np.diff(u) != 0)) + 1
    assert kept[changes].all(), "no reading is left out"


@pytest.mark.parametrize("rest", [0.3, 0.45])
def test_a_body_that_rests_a_good_part_of_the_time_is_no_slow_source(rest):
    stamps = np.arange(0.0, 8.0, 0.002)
    moves = stamps % 2.0 >= 2.0 * rest
    x = np.where(moves, np.sin(np.pi * (stamps % 2.0)), 0.0)
    assert not rows_between_readings([x, 3 * x], [x], stamps).any()

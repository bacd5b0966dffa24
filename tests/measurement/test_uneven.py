"""Uneven stamps, lost rows, pauses, wraps: what a log does to time does not reach the signals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td

RATE = 500.0


def motion(t):
    return 0.4 * np.sin(2 * np.pi * 0.9 * t) + 0.1 * np.sin(2 * np.pi * 4.1 * t)


def command(t):
    return 0.3 * np.sin(2 * np.pi * 1.3 * t) + 0.1 * np.cos(2 * np.pi * 6.0 * t)


def record_of(t, q, u, **more):
    return td.experiment(
        {"t": t, "q": q, "u": u},
        axis="revolute",
        position=more.pop("position", "q"),
        actuator_force="u",
        inertia=0.01,
        **more,
    ).records[0]


@given(seed=st.integers(0, 2**32 - 1), part=st.floats(0.001, 0.05))
@settings(max_examples=20)
def test_lost_rows_are_filled_where_they_were(seed, part):
    t = np.arange(2000) / RATE
    keep = np.random.default_rng(seed).random(2000) > part
    keep[[0, -1]] = True
    record = record_of(t[keep], motion(t[keep]), command(t[keep]))
    if len(record.segments) > 1:  # six rows in a row were lost
        return
    assert len(record.time) == 2000
    # a line over two samples errs by a h^2/2: 19 rad/s^2 at most for one lost row, 6^2 for five
    left = record.signals["device.position"] - motion(t)
    assert np.abs(left).max() < 1e-3
    assert np.array_equal(record.signals["device.actuator_force"][keep], command(t[keep]))


@given(seed=st.integers(0, 2**32 - 1), steps=st.floats(0.1, 6.0))
@settings(max_examples=20)
def test_a_lost_row_of_an_encoder_is_filled_within_a_step(seed, steps):
    """At 1 to 2.5 steps a row the older reading was held: a jump of two steps, or five."""
    generator = np.random.default_rng(seed)
    t = np.arange(500) / RATE
    truth = steps * RATE * t + generator.random() + 3.0 * np.sin(2 * np.pi * 2.0 * t)
    step = 1e-4
    q = step * np.round(truth)
    keep = np.ones(500, dtype=bool)
    keep[generator.choice(np.arange(10, 490, 3), 20, replace=False)] = False
    position = {"column": "q", "unit": "rad", "resolution": step}
    record = record_of(t[keep], q[keep], command(t[keep]), position=position)
    filled = record.signals["device.position"][~keep]
    assert np.abs(filled - q[~keep]).max() <= (1.0 + 1e-6) * step
    # no row lies outside of its neighbours, which never turn round here
    if steps > 0.2:
        assert np.diff(record.signals["device.position"]).min() >= -1e-6 * step


def test_stamps_that_are_true_move_the_readings():
    generator = np.random.default_rng(3)
    t = np.arange(3000) / RATE
    stamps = t + 0.1 / RATE * generator.standard_normal(3000)
    step = 1e-4
    record = record_of(stamps, step * np.round(motion(stamps) / step), command(stamps))
    left = record.signals["device.position"] - motion(record.time)
    assert "read at its stamps" in record.reading[0].rule
    # rounding alone leaves 0.29 steps, read as even the jitter would leave 5 steps
    assert np.sqrt(np.mean(left**2)) < 0.6 * step


def test_stamps_that_are_only_late_leave_the_readings():
    generator = np.random.default_rng(4)
    t = np.arange(3000) / RATE
    stamps = t + 0.1 / RATE * generator.standard_normal(3000)
    q = 1e-4 * np.round(motion(t) / 1e-4)
    record = record_of(stamps, q, command(t))
    assert "does not follow the stamps" in record.reading[0].rule
    assert np.array_equal(record.signals["device.position"], q)
    assert np.array_equal(record.signals["device.actuator_force"], command(t))


@given(seed=st.integers(0, 2**32 - 1), worst=st.floats(0.5, 1.4))
@settings(max_examples=20)
def test_a_few_rows_that_came_very_late_do_not_take_the_even_clock_away(seed, worst):
    """Rows of a network: written down in order, one of a hundred by half a row late or more."""
    generator = np.random.default_rng(seed)
    t = np.arange(2000) / RATE
    late = 0.1 * generator.random(2000)
    late[generator.choice(np.arange(10, 1990, 4), 20, replace=False)] += worst
    stamps = np.maximum.accumulate(t + late / RATE + 1e-9 * np.arange(2000))
    stamps += 1e-7 * np.arange(2000)  # no two alike where one overtook another
    record = record_of(stamps, motion(t), command(t))
    assert len(record.time) == 2000 and record.sample_time == pytest.approx(1 / RATE, rel=1e-3)
    assert np.array_equal(record.signals["device.position"], motion(t))


def test_rows_out_of_order_and_twice_are_put_right():
    t = np.arange(1000) / RATE
    order = np.arange(1000)
    order[[400, 401]] = [401, 400]
    order = np.insert(order, 600, 599)
    record = record_of(t[order], motion(t[order]), command(t[order]))
    assert np.array_equal(record.signals["device.position"], motion(t))
    assert {s.observed for s in record.reading} == {
        "1 row with the stamp of another",
        "2 rows out of order",
    }

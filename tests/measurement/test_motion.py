"""Smoothing and directions of a motion, against what their definitions say."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.measurement.motion import TRAVEL, direction_of, motion_of, play


def by_definition(position, patience):
    """The direction by its docstring, one sample after another, in whole steps."""
    runs, last = [], None
    for k in range(1, len(position)):
        change = position[k] - position[k - 1]
        if change:
            way = 1 if change > 0 else -1
            if last is not None and way == runs[-1][0] and k - last <= patience:
                runs[-1][2] = k
            else:
                runs.append([way, k, k])
            last = k
    direction = [0] * len(position)
    for way, first, end in runs:
        if end > first and abs(position[end] - position[first - 1]) > TRAVEL - 0.5:
            direction[first:end] = [way] * (end - first)
    return direction


@given(
    changes=st.lists(st.sampled_from([-1, 0, 0, 1, 1, 1, 2]), min_size=2, max_size=60),
    patience=st.integers(1, 4),
)
def test_a_direction_shows_over_enough_steps_the_same_way_without_a_rest(changes, patience):
    position = np.cumsum(np.array(changes, dtype=float))
    direction = direction_of(position, 1.0, 1.0, patience)
    assert direction.tolist() == by_definition(position.tolist(), patience)


@given(x=st.lists(st.floats(-5, 5), min_size=1, max_size=30), width=st.floats(0.0, 3.0))
def test_a_play_follows_only_what_goes_beyond_half_of_it(x, width):
    followed = play(np.array(x), width)
    assert followed[0] == x[0]
    assert np.all(np.abs(followed - x) <= 0.5 * width + 1e-12)
    for before, here, reading in zip(followed, followed[1:], x[1:], strict=False):
        if abs(reading - before) <= 0.5 * width:
            assert here == before


def test_position_other_position_and_their_rates_are_those_of_the_sine_that_was_read():
    time = np.arange(3000) / 500.0
    w, v = 2 * np.pi * 1.5, 2 * np.pi * 0.8
    motion = motion_of(
        body="device",
        file="fit.csv",
        time=time,
        position=np.sin(w * time),
        command=np.cos(w * time),
        interaction=None,
        sample_time=1 / 500.0,
        rows=slice(0, 3000),
        bandwidth=20.0,
        resolution=1e-6,
        further={"other_position": np.cos(v * time), "temperature": 300.0 + time},
    )
    inner = slice(500, -500)
    there = time[inner]
    for name, expected, size in (
        ("position", np.sin(w * there), 1.0),
        ("velocity", w * np.cos(w * there), w),
        ("acceleration", -(w**2) * np.sin(w * there), w**2),
    ):
        assert getattr(motion, name)[inner] == pytest.approx(expected, abs=1e-3 * size), name
    for name, expected, size in (
        ("other_position", np.cos(v * there), 1.0),
        ("other_velocity", -v * np.sin(v * there), v),
        ("other_acceleration", -(v**2) * np.cos(v * there), v**2),
        ("temperature", 300.0 + there, 1.0),
    ):
        assert motion.further[name][inner] == pytest.approx(expected, abs=1e-3 * size), name
    assert not motion.interaction.any()
    turns = np.abs(np.cos(w * there)) < 0.05
    assert np.array_equal(motion.direction[inner][~turns], np.sign(np.cos(w * there))[~turns])

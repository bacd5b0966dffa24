"""Where the learned force lies: a range of speeds, around reversals, or nowhere special."""

from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.diagnose.learnable import EXCESS_OF_A_PLACE, _where

MODEL = SimpleNamespace(body=lambda at: SimpleNamespace(axis=at))
ROWS = 1000
#: evenly spread from 0 to 1, in no order of time
SPEED = np.random.default_rng(2).permutation((np.arange(ROWS) + 0.5) / ROWS)
SLOWEST, FASTEST = (SPEED < 0.1) / 100.0, (SPEED > 0.9) / 100.0
EVEN = np.full(ROWS, 1.0 / ROWS)


def stretch(speed=SPEED, *, weight=1.0, axis="prismatic", turns=()):
    """Rows of 10 ms, of which every third counts, turned round at these rows that count."""
    every = 3 * len(speed)
    direction = np.ones(every, dtype=np.int8)
    for row in turns:
        direction[3 * row :] *= -1
    velocity = np.full(every, 5.0)  # of rows that do not count
    velocity[::3] = speed
    velocity *= direction
    motion = SimpleNamespace(velocity=velocity, direction=direction, sample_time=0.01, body=axis)
    return SimpleNamespace(motion=motion, keep=np.arange(0, every, 3), weight=weight)


@pytest.mark.parametrize(
    ("gain", "words"),
    [
        (SLOWEST, "below 0.1 m/s"),
        (FASTEST, "above 0.9 m/s"),
        (EVEN, ""),
        (np.zeros(ROWS), ""),
        (-SLOWEST, ""),
        # nine tenths of the gain lie below the half of the speeds
        (np.where(SPEED < 0.5, 0.9, 0.1) / 500.0, "below 0.5 m/s"),
    ],
)
def test_the_speeds_are_those_with_more_of_the_gain_than_of_the_rows(gain, words):
    assert _where(MODEL, [stretch()], [gain]) == words
    assert _where(MODEL, [stretch(axis="revolute")], [gain]) == words.replace("m/s", "rad/s")


@pytest.mark.parametrize("at_speed", [SLOWEST, FASTEST])
def test_a_small_excess_is_not_named(at_speed):
    """The part of the gain less that of the rows, here 0.9 of what lies there alone."""
    for part in (0.99, 1.01):
        share = part * EXCESS_OF_A_PLACE / 0.9
        words = _where(MODEL, [stretch()], [share * at_speed + (1.0 - share) * EVEN])
        assert bool(words) == (part > 1.0)


def test_what_lies_around_reversals_is_named_whatever_the_speeds():
    """Within 0.1 s: three rows to each side of the turn, which count every 30 ms."""
    turns = range(50, ROWS, 50)
    near = np.zeros(ROWS)
    for row in turns:
        near[row - 3 : row + 4] = 1.0
    assert _where(MODEL, [stretch(turns=turns)], [near]) == "around reversals"
    slow_too = near * (SPEED < 0.1)
    both = _where(MODEL, [stretch(turns=turns)], [slow_too])
    assert both == "below 0.1 m/s around reversals"
    assert _where(MODEL, [stretch(turns=turns)], [EVEN]) == ""


def test_speeds_of_two_kinds_have_no_common_range():
    two = [stretch(turns=[10, 500]), stretch(axis="revolute")]
    assert _where(MODEL, two, [SLOWEST, SLOWEST]) == ""
    near = np.zeros(ROWS)
    near[[10, 500]] = 1.0
    assert _where(MODEL, two, [near, np.zeros(ROWS)]) == "around reversals"


def test_rows_count_by_the_samples_that_they_stand_for():
    """Slow rows that stand for nine tenths of the samples have nine tenths of an even gain."""
    slow, fast = stretch(0.1 * SPEED, weight=9.0), stretch(0.1 + 0.9 * SPEED)
    assert _where(MODEL, [slow, fast], [EVEN, EVEN]) == ""
    # as much in all rows that stand for few samples as in all that stand for many
    assert _where(MODEL, [slow, fast], [EVEN, 9.0 * EVEN]) == "above 0.1 m/s"

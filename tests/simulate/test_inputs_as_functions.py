"""Inputs as people write them: functions of one number, of an array, sines."""

import math

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ModelError

BODY = td.Body("prismatic", {"inertia": 0.2}).with_effect(td.EFFECTS["viscous"], {"damping": 3.0})
LOOP = td.haptic_interface(BODY, hand=td.hand(mass=0.1, damping=2.0, stiffness=50.0))


def moved(force):
    return td.simulate_diagram(LOOP, duration=0.05, inputs={"R_D": force})["L"].values


@pytest.mark.parametrize(
    ("one_by_one", "at_once"),
    [
        (lambda t: 1.0 if t > 0.02 else 0.0, lambda t: np.where(t > 0.02, 1.0, 0.0)),
        (lambda t: math.sin(60 * t), lambda t: np.sin(60 * t)),
        (lambda t: max(0.0, t - 0.01), lambda t: np.maximum(0.0, t - 0.01)),
        (lambda t: 2.0, 2.0),
    ],
)
def test_a_function_of_one_number_is_an_input(one_by_one, at_once):
    """`if t > 0.02` ended in "The truth value of an array ... is ambiguous"."""
    assert np.array_equal(moved(one_by_one), moved(at_once))


def test_a_sine_is_an_input():
    force = td.sine(amplitude=2.0, frequency=8.0, phase=0.4)
    assert np.array_equal(moved(force), moved(lambda t: 2.0 * np.sin(2 * np.pi * 8.0 * t + 0.4)))


@pytest.mark.parametrize("force", [1.0, lambda t: 0 * t, np.ones(5)])
def test_the_force_of_a_prescribed_motion_is_no_input(force):
    """It was left out in silence."""
    motion = {"L": td.sine(amplitude=0.01, frequency=2.0)}
    with pytest.raises(ModelError, match="R_V is the force that moves L as prescribed"):
        td.simulate_diagram(LOOP, duration=0.01, motion=motion, inputs={"R_V": force})
    kept = td.simulate_diagram(LOOP, duration=0.01, motion=motion, inputs={"R_V": 0.0})
    assert np.any(kept["R_V"])


def test_frequencies_in_a_list_are_those_in_an_array():
    listed, array = (td.bode(LOOP, frequency=f) for f in ([1.0, 5.0], np.array([1.0, 5.0])))
    assert np.array_equal(listed.values(), array.values())
    for wrong in ([-1.0, 1.0], [float("nan")], [[1.0]]):
        with pytest.raises(ModelError, match=r"bode: frequency"):
            td.bode(LOOP, frequency=wrong)


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (float("nan"), "found the number nan"),
        (lambda t: np.where(t > 0.02, np.nan, 1.0), "is nan at 0.02005 s"),
        (lambda t: np.full_like(t, np.nan), "is nan at 0 s, expected finite numbers"),
        (np.full(1001, np.inf), "is inf at 0 s"),
        (lambda t: "2 N", 'its function returns the text "2 N", expected a number'),
        (lambda t: {"R_D": t}, "its function returns the dict"),
        (np.ones(10), "10 samples, expected 1001, one each 0.05 ms from 0 to 0.05 s.*np.interp"),
    ],
)
def test_an_input_that_is_no_number_is_not_called_an_unstable_loop(force, words):
    """NaN ended in "signals grow beyond all bounds", a text in a ValueError."""
    with pytest.raises(ModelError, match=words):
        moved(force)
    with pytest.raises(ModelError, match=words):
        td.simulate_many(LOOP, {}, duration=0.05, inputs={"R_D": force})

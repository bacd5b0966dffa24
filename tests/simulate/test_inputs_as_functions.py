"""Inputs as people write them: functions of one number, of an array, sines."""

import math

import numpy as np
import pytest

import teleopdesign as td

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

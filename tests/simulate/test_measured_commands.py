"""Signals that the computer makes itself and that are listed as measured, too: simulated alike."""

import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.simulate import simulate

GAIN = controller("gain", {"gain": 50.0})
SLOW = controller("low_pass", {"bandwidth": 20.0})
PLANT = Moving("M", body(0.1, viscous__damping=1.0), "x", "u", {"f": 1.0}, "f")
LOOP = Control("K", GAIN, "e", "p", "x")
ERROR = Junction("e", {"d": 1.0, "x": -1.0})
OUTSIDE = {"f": "force", "d": "position"}


def wire(*blocks, sums, measured):
    return Diagram("d", (PLANT, *blocks), (ERROR, *sums), OUTSIDE, ("x", *measured))


#: wiring without further sensors, and the signals of it that a user may want to see
WIRINGS = {
    "one controller": ((LOOP,), (Junction("u", {"p": 1.0}),), ("u", "p", "e", "x")),
    "the command itself": ((Control("K", GAIN, "e", "u", "x"),), (), ("u", "e")),
    "an analog path beside": (
        (LOOP, Control("F", SLOW, "f", "q", analog=True)),
        (Junction("u", {"p": 1.0, "q": 0.5}),),
        ("u", "p"),
    ),
    "two controllers in series": (
        (LOOP, Control("G", SLOW, "p", "g", "x")),
        (Junction("u", {"g": 1.0}),),
        ("u", "g", "p"),
    ),
    "a sum before the command": (
        (LOOP, Control("G", SLOW, "e", "g", "x")),
        (Junction("w", {"p": 1.0, "g": 2.0}), Junction("u", {"w": 1.0, "d": 1.0})),
        ("u", "w", "g"),
    ),
    "a sum with an analog path before the command": (
        (LOOP, Control("F", SLOW, "f", "q", analog=True)),
        (Junction("w", {"p": 1.0, "q": 2.0}), Junction("u", {"w": 1.0})),
        ("u", "w", "p"),
    ),
    "a filter of the command": (
        (LOOP, Control("G", SLOW, "u", "g", "x")),
        (Junction("u", {"p": 1.0, "g": 0.1}),),
        ("u", "g"),
    ),
}


@pytest.mark.parametrize("name", WIRINGS)
def test_what_the_computer_makes_needs_no_sensor(name):
    blocks, sums, names = WIRINGS[name]
    run = {"duration": 0.05, "inputs": {"f": 1.0, "d": 0.01}, "jit": False}
    bare = simulate(wire(*blocks, sums=sums, measured=()), **run)
    assert np.ptp(bare["u"].values) > 0.1
    for measured in (*((n,) for n in names if n != "x"), tuple(n for n in names if n != "x")):
        same = simulate(wire(*blocks, sums=sums, measured=measured), **run)
        for signal in ("x", "x_velocity", "u"):
            assert np.array_equal(same[signal].values, bare[signal].values), (measured, signal)

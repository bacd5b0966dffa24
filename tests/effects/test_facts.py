"""What an effect holds its parameters against: records of one body, and elements that slip."""

import numpy as np

from teleopdesign.effects import RecordFacts
from teleopdesign.effects._facts import speeds_vary_by_place

TIME = np.linspace(0.0, 3.0, 3000)


def facts(**changed):
    """One sine about zero, as a link under gravity makes it."""
    places, speeds = 0.5 * np.sin(2 * np.pi * TIME), np.pi * np.cos(2 * np.pi * TIME)
    known = {
        "travel": 1.0,
        "sweep": 1.0,
        "step": 1e-4,
        "stroke": 0.5,
        "force": 3.0,
        "speed": np.pi,
        "film": 0.1,
    }
    body = {"inertia": 0.1, "coulomb.level": 0.5, "gravity.phase": 0.3}
    arguments = {"axis": "revolute", "body": body, "places": places, "speeds": speeds, **known}
    return RecordFacts(**arguments | changed)


def test_one_sine_tells_no_force_of_the_place_from_one_of_the_speed_two_sines_do():
    one = speeds_vary_by_place(np.cos, facts())
    assert one is not None and "one speed only" in one
    # the same places at half the speed too
    both = {"places": np.tile(facts().places, 2)}
    both["speeds"] = np.r_[facts().speeds, 0.5 * facts().speeds]
    assert speeds_vary_by_place(np.cos, facts(**both)) is None

"""What an effect holds its parameters against: records of one body, and elements that slip."""

from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.effects import EFFECTS, RecordFacts
from teleopdesign.effects._elements import softest_first
from teleopdesign.effects._facts import follows_gravity, slip_is_observable, speeds_vary_by_place

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


def test_friction_that_is_largest_where_gravity_is_may_be_friction_by_the_load():
    sentence = follows_gravity(lambda place: 1.0 + np.abs(np.sin(place + 0.3)), facts())
    assert sentence is not None and "load_dependent_friction" in sentence
    assert follows_gravity(lambda place: 2.0 - np.abs(np.sin(place + 0.3)), facts()) is None
    assert follows_gravity(lambda place: np.ones_like(place), facts()) is None, "nothing varies"
    assert follows_gravity(np.abs, facts(body={"inertia": 0.1})) is None, "there is no gravity"


def test_elements_are_ordered_by_stiffness_and_the_first_carries_the_rest():
    parameters = {"stiffness_1": 9.0, "stiffness_2": 3.0, "stiffness_3": 27.0, "stiffness_4": 1.0}
    parameters |= {"level_2": 0.2, "level_3": 0.3, "level_4": 1e-4}
    values = softest_first(parameters, {"coulomb.level": 1.0})
    # the first carries 1 - 0.2 - 0.3; the fourth carries next to nothing and comes last
    assert [values[f"stiffness_{i}"] for i in (1, 2, 3, 4)] == [3.0, 9.0, 27.0, 1.0]
    levels = [values[f"level_{i}"] for i in (2, 3, 4)]
    assert levels == pytest.approx([0.4999, 0.3, 1e-4])


def test_what_slips_within_no_stretch_of_a_record_is_a_spring_though_two_records_lie_apart():
    """Of a pendulum that swung to each side in a record of its own, a hysteresis was named."""
    assert slip_is_observable("the bristle", [0.8], facts(travel=2.0, sweep=2.0)) is None
    sentence = slip_is_observable("the bristle", [0.8], facts(travel=2.0, sweep=0.7))
    assert sentence is not None and "never slips within the travel of 0.7 rad" in sentence
    soft = {"stiffness_1": 0.5, "stiffness_2": 5.0, "stiffness_3": 50.0, "stiffness_4": 500.0}
    values = SimpleNamespace(**soft, level_2=0.1, level_3=0.0, level_4=0.0)  # element 1: 0.8 rad
    plausible = EFFECTS["maxwell_slip"].plausible
    assert plausible(values, facts(travel=2.0, sweep=2.0)) is None
    sentence = plausible(values, facts(travel=2.0, sweep=1.0))
    assert sentence is not None and "in one direction only within the travel of 1 rad" in sentence
    soft["stiffness_1"] = 0.1  # 4 rad: beside others that slip, this one is a spring
    sentence = plausible(SimpleNamespace(**soft, level_2=0.1, level_3=0.0, level_4=0.0), facts())
    assert sentence is not None and "never slips within the travel of 1 rad" in sentence


def test_an_element_that_reaches_next_to_no_force_within_the_travel_does_not_matter():
    """Beside three springs that slip, a fit of four elements left a fourth without a force."""
    stiffness = {"stiffness_1": 0.01, "stiffness_2": 5.0, "stiffness_3": 50.0, "stiffness_4": 500.0}
    values = SimpleNamespace(**stiffness, level_2=0.1, level_3=0.1, level_4=0.1)
    plausible = EFFECTS["maxwell_slip"].plausible
    assert plausible(values, facts()) is None, "0.01 N m at most, beside a friction of 0.5 N m"
    values.stiffness_1 = 0.1
    assert "never slips" in plausible(values, facts())

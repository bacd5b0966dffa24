"""Gravity and a spring: each one's file says where the other would do as well."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.effects import EFFECTS, RecordFacts


def facts(low, high):
    return RecordFacts(
        axis="revolute",
        travel=high - low,
        sweep=high - low,
        step=1e-5,
        stroke=1.0,
        force=5.0,
        speed=1.0,
        film=1.0,
        body={},
        places=np.linspace(low, high, 400),
        speeds=np.ones(400),
    )


def undetermined(phase, low, high):
    p = SimpleNamespace(amplitude=2.0, phase=phase)
    return EFFECTS["gravity"].undetermined(p, facts(low, high))


@pytest.mark.parametrize("phase", [0.0, 0.3, np.pi])
def test_near_the_hanging_place_a_spring_and_a_constant_force_would_do_as_well(phase):
    sentence = undetermined(phase, -0.5 - phase, 0.5 - phase)
    # sin x less its best line over half a radian either way: x^3 / 6 leaves 0.0032 (rms) of 0.28
    assert (
        "spring and a constant force" in sentence
        and "within 1.1 %" in sentence
        and "1 rad" in sentence
    )


@pytest.mark.parametrize(("phase", "low", "high"), [(0.0, -2.0, 2.0), (0.0, 1.0, 2.2)])
def test_over_a_wide_travel_or_near_the_level_gravity_is_recognised_by_its_curvature(
    phase, low, high
):
    assert undetermined(phase, low, high) is None


def test_a_link_that_swings_freely_is_pulled_by_more_than_any_sensor_measures():
    """Swung up by 5 N m against 20 N m of gravity: the inertia takes the rest."""
    plausible, p = EFFECTS["gravity"].plausible, SimpleNamespace(amplitude=20.0, phase=0.0)
    swinging = replace(facts(-3.0, 3.0), acting=5.0 + 18.0)
    assert plausible(p, swinging) is None
    held = replace(facts(0.99, 1.01), acting=5.0 + 0.1)
    assert "a constant force and a spring" in plausible(p, held)
    # a link that hangs down is never lifted: 4 N m act at 0.2 rad
    hanging = replace(facts(-0.2, 0.2), acting=5.0 + 0.1)
    assert plausible(p, hanging) is None

"""What follows from an effect's law: is it linear, does it repeat along the way, what leads a tip.

Held against what the physics says of some effects; another effect needs no entry here.
"""

from math import pi

import pytest

from teleopdesign.effects import (
    BLOCK_EFFECTS,
    EFFECTS,
    depends_on_position,
    depends_on_time,
    period,
)

KNOWN = {**EFFECTS, **BLOCK_EFFECTS}


#: what a law repeats after along the way; None: it depends on the position, and never repeats
REPEATS = {
    "arm": None,
    "cogging": "period",
    "cogging_harmonic": "period",
    "contact_hysteresis": None,
    "gravity": 2 * pi,
    "hardening_spring": None,
    "position_dependent_friction": "period",
    "position_dependent_gain": None,
    "spring": None,
    "stops": None,
    "torque_ripple": "period",
}


@pytest.mark.parametrize("name", sorted({*REPEATS, "coulomb", "viscous", "friction_drift"}))
def test_what_depends_on_the_place_and_on_time_is_that_of_the_physics(name):
    assert depends_on_position(KNOWN[name]) == (name in REPEATS)
    assert period(KNOWN[name]) == REPEATS.get(name)
    assert depends_on_time(KNOWN[name]) == (name == "friction_drift")

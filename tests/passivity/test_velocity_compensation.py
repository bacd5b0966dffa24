"""Friction cancelled by velocity: the condition, its certificates, and strokes that refute."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import Strokes, confirmed_motion, velocity_compensation
from teleopdesign.simulate import Sampling

sizes = st.floats(-3, 3).map(lambda x: 10**x)


@given(
    level=sizes,
    compensator_level=sizes,
    smoothing=sizes,
    damping=sizes | st.just(0.0),
    gives=st.booleans(),
)
def test_the_condition_is_that_of_the_square_roots(
    level, compensator_level, smoothing, damping, gives
):
    claim = velocity_compensation(
        coulomb_level=level,
        compensator_level=compensator_level,
        smoothing_velocity=smoothing,
        viscous_damping=damping,
        presliding_stiffness=1e4 * level if gives else None,
    )
    least = 0.0 if gives else level
    room = math.sqrt(least) + math.sqrt(smoothing * damping) - math.sqrt(compensator_level)
    # at 1e-9 of the levels the float formula may sit on the other side
    if abs(room) > 1e-9 * math.sqrt(compensator_level):
        assert claim.status == ("proved" if room > 0 else "refuted")
    if claim.status == "refuted":
        assert claim.record.replay() > 0


def device(compensator_level, damping, gives):
    body = td.Body("prismatic", {"inertia": td.Value(1e-3)})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": 0.5})
    body = body.with_effect(td.EFFECTS["viscous"], {"damping": damping})
    if gives:
        presliding = td.EFFECTS["presliding"].without("bristle_damping")
        body = body.with_effect(presliding, {"stiffness": gives})
    law = controller("smoothed_coulomb", {"level": compensator_level, "smoothing_velocity": 0.01})
    return haptic_interface(body, cancellation=law)


# in a computer, another loop to compile, the search finds it too
COMPUTERS = ["continuous", pytest.param(Sampling(period=1e-4, delay=1e-4), marks=pytest.mark.slow)]


@pytest.mark.parametrize("computer", COMPUTERS, ids=["continuous", "sampled"])
def test_a_contact_that_gives_is_driven_by_a_tenth_of_its_friction(computer):
    """0.05 N of the 0.5 N that a contact has: passive were it ideal; its small motion is not."""
    small = Strokes((2e-7, -2e-7), speed=2e-5)
    given_out = confirmed_motion(device(0.05, 0.5, 2e4), small, computer=computer)
    assert given_out is not None and given_out.replay() > 0
    assert confirmed_motion(device(0.004, 0.5, 2e4), small, computer=computer) is None

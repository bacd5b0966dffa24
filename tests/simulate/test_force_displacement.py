"""Force over displacement: slope and width of a loop, and what a teleoperator shows of a spring."""

import numpy as np
import pytest
from devices import body
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.controllers import controller
from teleopdesign.diagrams import teleoperator
from teleopdesign.simulate import force_displacement, loop_of, simulate, sine

TIME = np.linspace(0.0, 1.0, 2001)
COUPLING, SPRING = 2000.0, 500.0


@given(
    stiffness=st.floats(0.0, 1e4),
    friction=st.floats(0.0, 5.0),
    offset=st.floats(-5.0, 5.0),
    centre=st.floats(-0.1, 0.1),
)
def test_a_spring_with_coulomb_friction_is_a_loop_of_that_slope_and_twice_the_level(
    stiffness, friction, offset, centre
):
    x = centre + 0.02 * np.sin(2 * np.pi * TIME)
    force = stiffness * x + offset + friction * np.sign(np.gradient(x))
    loop = loop_of(x, force)
    size = stiffness * 0.12 + abs(offset) + friction + 1.0
    assert loop.width == pytest.approx(2 * friction, abs=1e-9 * size)  # exact but for rounding
    assert loop.stiffness == pytest.approx(stiffness, abs=1e-9 * size / 0.02)


def test_only_displacements_within_the_range_count():
    x = np.sin(2 * np.pi * TIME)
    force = np.where(x > 0.0, 3.0 * x, x)
    assert loop_of(x, force, within=(0.1, 0.9)).stiffness == pytest.approx(3.0, rel=1e-9)
    assert loop_of(x, force, within=(-0.9, -0.1)).stiffness == pytest.approx(1.0, rel=1e-9)


@pytest.fixture(scope="module")
def through_a_coupling():
    """A light teleoperator without friction, slowly moved against a spring."""
    diagram = teleoperator(
        body(inertia=1e-3),
        body(inertia=1e-3, viscous__damping=1.0),
        coupling=controller("spring_damper", {"stiffness": COUPLING, "damping": 0.0}),
        environment=body(inertia=0.0, spring__stiffness=SPRING),
    )
    simulation = simulate(
        diagram,
        duration=2.0,
        motion={"X_m": sine(amplitude=0.01, frequency=1.0)},
        computer="continuous",
    )
    return force_displacement({"spring": simulation}, after=1.0)


def test_the_user_feels_the_coupling_and_the_environment_in_series(through_a_coupling):
    """k k_E/(k + k_E); inertia and damping give less than 1e-3 of it at 1 Hz."""
    series = COUPLING * SPRING / (COUPLING + SPRING)
    assert through_a_coupling.loops["spring"].stiffness == pytest.approx(series, rel=1e-3)
    assert through_a_coupling.environment["spring"].stiffness == pytest.approx(SPRING, rel=1e-3)


def test_a_spring_has_no_loop_and_the_user_feels_the_slave_damping(through_a_coupling):
    """The width at the middle of the stroke: 2 B v, seen through the coupling."""
    assert abs(through_a_coupling.environment["spring"].width) < 1e-6
    speed = 2 * np.pi * 0.01 * COUPLING / (COUPLING + SPRING)
    felt = 2 * 1.0 * speed * COUPLING / (COUPLING + SPRING)
    # over the middle half of the stroke the speed is 0.87 to 1 of its peak
    width = through_a_coupling.loops["spring"].width
    assert 0.85 * felt < width < 1.01 * felt

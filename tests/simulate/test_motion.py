"""A prescribed motion: its velocity and acceleration belong to its position."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.simulate import sampled_motion, sine


@given(
    amplitude=st.floats(1e-4, 1.0),
    frequency=st.floats(0.1, 20.0),
    phase=st.floats(-3.0, 3.0),
)
def test_a_sinusoid_has_its_exact_derivatives(amplitude, frequency, phase):
    """Central differences over 1e-4 of a period: their error is (2 pi 1e-4)^2/6, below 1e-7."""
    motion = sine(amplitude=amplitude, frequency=frequency, phase=phase)
    time, step = np.linspace(0.0, 1.0, 50) / frequency, 1e-4 / frequency
    rate = 2 * np.pi * frequency
    for order, (value, slope) in enumerate(zip(motion.all[:-1], motion.all[1:], strict=True)):
        difference = (value(time + step) - value(time - step)) / (2 * step)
        size = amplitude * rate ** (order + 1)
        assert np.abs(difference - slope(time)).max() < 1e-6 * size


def test_a_motion_through_samples_meets_them_and_rests_beyond_them():
    time = np.linspace(0.0, 1.0, 41)
    position = 0.01 * np.sin(2 * np.pi * time)
    motion = sampled_motion(time, position)
    assert motion.position(time) == pytest.approx(position, abs=1e-12)
    beyond = np.array([-0.5, 1.5])
    assert motion.position(beyond) == pytest.approx(position[[0, -1]], abs=1e-12)
    assert not motion.velocity(beyond).any() and not motion.acceleration(beyond).any()


def test_a_motion_through_samples_of_a_polynomial_of_fifth_order_is_that_polynomial():
    """A quintic spline reproduces quintics; what remains is rounding."""
    time = np.linspace(0.0, 1.0, 12)
    motion = sampled_motion(time, time**5 - time**2)
    inside = np.linspace(0.05, 0.95, 30)
    assert motion.velocity(inside) == pytest.approx(5 * inside**4 - 2 * inside, abs=1e-9)
    assert motion.acceleration(inside) == pytest.approx(20 * inside**3 - 2, abs=1e-8)


@pytest.mark.parametrize("length", [1e-5, 1e-7, 1.4e-9])
def test_ideal_friction_stays_within_its_level_however_short_its_bristle(length):
    """A bristle that turns within one step ends far beyond its length; its force does not."""
    device = td.hand(mass=0.2, damping=1.0, stiffness=0.0)
    device = device.with_effect(td.EFFECTS["coulomb"], values={"level": 0.3})
    motion = sine(amplitude=1.4e-3, frequency=45.2)
    run = td.simulate_diagram(
        td.haptic_interface(device),
        duration=0.1,
        motion={"L": motion},
        give=length,
        every_step=True,
    )
    assert abs(run["Z_M_friction"].values).max() <= 0.3 * (1 + 1e-9)

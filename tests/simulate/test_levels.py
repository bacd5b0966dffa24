"""Friction below zero in one direction is refused: its bristle would grow without bound."""

import numpy as np
import pytest
from devices import body

from teleopdesign.base.errors import ModelError
from teleopdesign.diagrams import haptic_interface
from teleopdesign.simulate import simulate, simulate_many, sine

MOTION = {"L": sine(amplitude=0.01, frequency=5.0)}


def device(half_difference):
    return haptic_interface(
        body(0.1, coulomb__level=0.5, coulomb_asymmetry__half_difference=half_difference)
    )


@pytest.mark.parametrize(("half_difference", "way"), [(0.6, "backward"), (-0.6, "forward")])
def test_a_level_below_zero_is_refused_with_its_direction(half_difference, way):
    """It was simulated: 1e35 N after 4 ms, which is finite."""
    with pytest.raises(ModelError, match=f"Z_M: friction of -0.1 N {way} .*no less than 0"):
        simulate(device(half_difference), duration=0.01, motion=MOTION, jit=False)


def test_a_level_that_falls_below_zero_in_fast_sliding_alone_is_refused():
    slippery = body(
        0.1,
        coulomb__level=0.5,
        stribeck__extra_static_level=0.3,
        stribeck__stribeck_velocity=0.01,
        coulomb_asymmetry__half_difference=0.6,
    )
    with pytest.raises(ModelError, match="friction of -0.1 N backward"):
        simulate(haptic_interface(slippery), duration=0.01, motion=MOTION, jit=False)


@pytest.mark.slow  # a loop of lanes; simulate/test_many.py has cases that fail beside others
def test_among_many_cases_only_those_are_refused():
    simulation = simulate_many(
        device(0.1),
        {"Z_M.coulomb_asymmetry.half_difference": [0.1, 0.6, 0.5]},
        duration=0.01,
        motion=MOTION,
    )
    reasons = [str(r) for r in simulation["reason"].values]
    assert reasons[0] == "" == reasons[2] and "friction of -0.1 N backward" in reasons[1]


def test_a_level_of_zero_one_way_is_simulated():
    simulation = simulate(device(0.5), duration=0.01, motion=MOTION, jit=False)
    assert np.isfinite(simulation["R_V"].values).all()

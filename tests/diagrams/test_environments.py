"""Environments and hands to design with."""

import numpy as np
import pytest
from devices import body

from teleopdesign.blocks import (
    hand,
    hunt_crossley,
)
from teleopdesign.diagrams import haptic_interface
from teleopdesign.frequency import transfer_function
from teleopdesign.simulate import simulate

HERTZ = {"stiffness": 2e3, "depth": 1e-3, "reference_velocity": 0.5}
ARM = {"inertia": 1.2, "damping": 8.0, "stiffness": 120.0}


def run(made, **arguments):
    arguments = {"computer": "continuous", "jit": False, "every_step": True} | arguments
    return simulate(haptic_interface(made), **arguments)


@pytest.mark.parametrize("speed", [0.005, 0.02])
def test_a_slow_impact_returns_at_one_less_alpha_v(speed):
    """alpha = 2/(3 v_0); 0.6 (alpha v)^2 is the next order of the restitution."""
    result = run(
        hunt_crossley(body(0.2), **HERTZ),
        initial={"L_velocity": speed},
        duration=0.1,
        step=1e-4,
    )
    assert result["L"].values[-1] < 0
    alpha = 2 / (3 * 0.5)
    ratio = -result["L_velocity"].values[-1] / speed
    assert ratio == pytest.approx(1 - alpha * speed, abs=(alpha * speed) ** 2 + 1e-5)


def test_a_gripping_hand_is_grip_and_arm_in_series():
    """At rest two springs in series; far above the arm's resonance the grip alone."""
    made = hand(mass=0.1, damping=2.0, stiffness=400.0, arm=ARM)
    system, left_out = transfer_function(haptic_interface(made), output="L", input="R_V")
    assert left_out == ()
    assert float(np.real(system(0))) == pytest.approx(1 / 400 + 1 / 120, rel=1e-9)
    s = 2j * np.pi * 5
    grip, held = 2.0 * s + 400, 8.0 * s + 120
    behind = 1.2 * s**2 + held
    assert 1 / system(s) == pytest.approx(0.1 * s**2 + grip * behind / (grip + behind), rel=1e-9)

"""A friction of springs that slip never exceeds its level, however far a step carries a spring."""

import numpy as np
import pytest
from devices import body

import teleopdesign as td

LEVELS = np.array([0.2, 0.15, 0.1, 0.05])  # N
AMPLITUDE, RATE = 0.012, 2 * np.pi * 1.3  # m, rad/s


@pytest.mark.parametrize("stiffest", [4e4, 1e7])
def test_the_force_is_that_of_springs_that_are_clipped_along_the_travel(stiffest):
    stiffness = np.array([3e3, 1e4, 4e4, stiffest])
    later = {f"maxwell_slip__stiffness_{i}": k for i, k in enumerate(stiffness, 1)}
    later |= {f"maxwell_slip__level_{i}": w for i, w in enumerate(LEVELS[1:], 2)}
    diagram = td.haptic_interface(body(coulomb__level=0.5, **later))
    motion = td.sine(amplitude=AMPLITUDE, frequency=1.3)
    run = td.simulate_diagram(diagram, duration=0.8, motion={"L": motion}, computer="continuous")
    force, expected = np.zeros(4), [0.0]
    travel = AMPLITUDE * np.sin(RATE * np.linspace(0, 0.8, 200 * (len(run["L"]) - 1) + 1))
    for k, step in enumerate(np.diff(travel), 1):
        force = np.clip(force + stiffness * step, -LEVELS, LEVELS)
        expected += [force.sum()] if k % 200 == 0 else []
    assert np.abs(run["Z_M_friction"].values).max() <= 0.5 + 1e-12
    assert np.abs(run["Z_M_friction"].values - expected).max() < 0.02

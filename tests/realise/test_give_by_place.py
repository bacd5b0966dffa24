"""Ideal friction deflects by `give` at most, also where its level is small at rest or at zero."""

import numpy as np
import pytest
from devices import body

import teleopdesign as td


@pytest.mark.parametrize("amplitude", [0.5, 0.99])
def test_the_work_of_a_cycle_is_that_of_the_level_along_the_travel(amplitude):
    period, travel = 0.02, 0.012
    device = body(
        inertia=1e-3, coulomb__level=0.5, position_dependent_friction__amplitude=amplitude,
        position_dependent_friction__period=period, position_dependent_friction__phase=-np.pi / 2,
    )  # fmt: skip
    run = td.simulate_diagram(
        td.haptic_interface(device),
        duration=2.0,
        motion={"L": td.sine(amplitude=travel, frequency=1.0)},
        computer="continuous",
    )
    t = 1e-3 * np.arange(len(run["L"]))
    v = travel * 2 * np.pi * np.cos(2 * np.pi * t)
    x = travel * np.sin(2 * np.pi * t)
    level = 0.5 * (1 + amplitude * np.sin(2 * np.pi * x / period - np.pi / 2))
    last = t > 1.0
    work = np.sum(run["Z_M_friction"].values[last] * v[last])
    assert work == pytest.approx(np.sum(level[last] * np.abs(v[last])), rel=5e-3)

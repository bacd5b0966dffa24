"""Ideal friction as a bristle: how stiff it is, and how it is damped while it sticks."""

import numpy as np
import pytest
from devices import body

from teleopdesign.blocks import Body
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.realise.simulated import with_bristle
from teleopdesign.simulate import simulate


def test_a_bristle_gives_by_its_deflection_and_is_damped_as_its_ratio_says():
    """Damping ratio: the damping over 2 sqrt(k m)."""
    stuck = with_bristle(body(0.5, coulomb__level=2.0), 1e-4, damping_ratio=0.7)
    values = {n: v.value for n, v in stuck.parameters.items()}
    assert values["presliding.stiffness"] == pytest.approx(2.0 / 1e-4)
    assert values["presliding.bristle_damping"] == pytest.approx(2 * 0.7 * (2e4 * 0.5) ** 0.5)


def pendulum(share):
    """A pendulum whose gear rubs with its load alone."""
    stated = {
        "gravity": {"amplitude": 2.0, "phase": 0.0},
        "coulomb": {"level": 0.0},
        "load_dependent_friction": {"coefficient": 0.3, "output_share": share},
    }
    made = Body("revolute", {"inertia": 0.05})
    for name, values in stated.items():
        made = made.with_effect(EFFECTS[name], values)
    return made


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_friction_that_is_a_part_of_the_load_alone_has_a_bristle(share):
    """Without a load its level is zero, and so would be the stiffness."""
    stiffness = with_bristle(pendulum(share), 1e-4).parameters["presliding.stiffness"].value
    assert stiffness == pytest.approx(0.3 * (2.0 + 0.5) / 1e-4)  # gravity, and 10 rad/s^2


@pytest.mark.parametrize(("torque", "holds"), [(0.16, True), (0.10, False)])
def test_a_gear_holds_a_load_by_the_friction_that_the_load_makes(torque, holds):
    """At 0.1 rad the load is 0.2 N m, and friction up to 0.06 N m."""
    device = haptic_interface(pendulum(1.0))
    run = {"duration": 0.3, "initial": {"L": 0.1}, "jit": False, "step": 2e-4}
    moved = np.abs(simulate(device, inputs={"R_D": torque}, **run)["L"].values - 0.1).max()
    assert moved < 2e-3 if holds else moved > 0.02

"""Ideal friction as a bristle: how stiff it is, and how it is damped while it sticks."""

import numpy as np
import pytest
from devices import body

from teleopdesign.blocks import Body
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.realise.bristle import with_bristle
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


@pytest.mark.slow
@pytest.mark.parametrize("deflection", [0.3e-3, 0.03e-3])
def test_a_motor_drives_a_load_through_such_a_gear_whatever_the_bristle(deflection):
    """The load goes through zero twice a cycle; ideal friction in sliding, by small steps."""
    made = pendulum(1.0).with_effect(EFFECTS["viscous"], {"damping": 1.0})
    stuck = with_bristle(made, deflection, damping_ratio=0.5)

    def push(t):
        return 3.0 * np.sin(2 * np.pi * 0.8 * t)

    moved = simulate(
        haptic_interface(stuck), duration=1.0, inputs={"R_D": push}, jit=False, step=2e-4,
        computer="continuous",
    )  # fmt: skip
    x = v = 0.0
    step = 1e-5
    for k in range(100_000):
        arriving, load = push(k * step) - v, 2.0 * np.sin(x)
        # what accelerates, if the load is a part L of what arrives: L (1 + 0.3 sgn(L v)) = arriving
        carried = arriving / (1.0 + 0.3 * np.sign(arriving * v))
        if v == 0.0:
            carried = load if abs(arriving - load) < 0.3 * abs(load) else arriving
        before, v = v, v + step * (carried - load) / 0.05
        v = 0.0 if before * v < 0.0 else v
        x += step * v
    # each reversal begins a bristle's length late; the Euler steps leave 1e-5
    assert moved["L"].values[-1] == pytest.approx(x, abs=4 * deflection + 1e-4)

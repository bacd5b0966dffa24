"""What simulated motions say of the energy that a designed device takes, and what they do not."""

import pytest

import teleopdesign as td
from teleopdesign.design.assumptions import StatedMotion
from teleopdesign.design.device import acting_gain
from teleopdesign.design.verdict import energy_claim, energy_taken
from teleopdesign.realise.reach import Reach

SAMPLING = td.Sampling(period=1e-3, delay=1e-3, encoder_step=5e-6, velocity_bandwidth=50)


def reach(command=9.0, peak_speed=0.13):
    return Reach(-0.03, 0.03, peak_speed, 0.05, command, 15.0, 1e-3, 5e-6, 1e-5, True)


def loaded_device():
    """A bare device, passive: all of its parts brake or store."""
    device = td.hand(mass=0.2, damping=1.0, stiffness=0.0)
    device = device.with_effect(td.EFFECTS["coulomb"], values={"level": 0.3})
    return device.with_effect(td.EFFECTS["load_dependent_friction"], values={"coefficient": 0.3})


def test_a_motion_that_no_step_resolves_says_nothing_of_energy():
    diagram = td.haptic_interface(loaded_device())
    assert energy_taken(diagram, StatedMotion(0.0, 1e-3, 30.0), SAMPLING) is None
    claim = energy_claim(diagram, StatedMotion(0.0, 1e-3, 5.0), reach(), SAMPLING, axis="prismatic")
    assert claim.holds and claim.verdict.margin > 0.0
    nothing = energy_claim(
        diagram, StatedMotion(0.0, 1e-3, 30.0), reach(0.0, 0.19), SAMPLING, axis="prismatic"
    )
    assert nothing.status in ("unknown", "evidence") and nothing.holds is not False


def test_a_motor_that_was_off_has_the_gain_of_its_model():
    assert acting_gain(loaded_device(), reach(command=0.0), errors=2.0) == pytest.approx(1.0)

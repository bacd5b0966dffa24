"""The stiffness at which a Dahl cancellation begins to oscillate, against theory."""

import pytest

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.blocks import Body, Value
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.identify import largest_stiffness_without_oscillation
from teleopdesign.simulate import Sampling

LEVEL, CANCELLED, HAND = 0.5, 0.4, 300.0


def loop(presliding=None):
    """0.2 kg with 0.5 N of friction, 0.4 N cancelled, on a hand of 0.3 kg and 300 N/m."""
    body = Body("prismatic", {"inertia": Value(0.2)})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": LEVEL})
    body = body.with_effect(td.EFFECTS["viscous"], {"damping": 1.0})
    if presliding:
        body = body.with_effect(td.EFFECTS["presliding"], {"stiffness": presliding})
    hand = Body("prismatic", {"inertia": Value(0.3)})
    hand = hand.with_effect(td.EFFECTS["spring"], {"stiffness": HAND})
    cancellation = controller("dahl", {"level": CANCELLED, "stiffness": 1e3})
    return haptic_interface(body, hand=hand, cancellation=cancellation)


def largest(diagram, **more):
    options = {"smallest": 100.0, "largest": 1e5, "kick": 1e-3, "duration": 1.0}
    return largest_stiffness_without_oscillation(
        diagram, computer=Sampling(period=1e-3, delay=1e-3), **{**options, **more}
    )


def test_on_ideal_coulomb_friction_no_stiffness_oscillates():
    """P38: within its level any cancellation takes energy, sampled and late as it may be."""
    assert largest(loop()).stiffness == float("inf")


@pytest.mark.parametrize("presliding", [5e3, 2e4])
def test_on_presliding_it_is_the_stiffness_of_contact_and_hand(presliding):
    """Small motion is a spring sigma_p + k_H - sigma_D: gone at sigma_D = sigma_p + k_H."""
    stiffness = largest(loop(presliding))
    # the kick leaves the straight part of the bristle: its spring is softer there
    assert stiffness.stiffness == pytest.approx(presliding + HAND, rel=0.08)
    assert stiffness.oscillates <= 1.02 * stiffness.stiffness * (1 + 1e-9)
    # P43 is stricter: passive for any hand
    assert stiffness.stiffness > presliding * (CANCELLED / LEVEL) ** 0.5


def test_the_ends_of_the_range_are_reported():
    assert largest(loop(5e3), largest=1e3).stiffness == float("inf")
    assert largest(loop(5e3), smallest=2e4).stiffness == 0.0


def test_a_loop_without_a_dahl_cancellation_is_refused():
    with pytest.raises(ModelError, match="no block C with the law dahl"):
        largest(loop().without("C"))
    with pytest.raises(ModelError, match="expected above 0 and below largest"):
        largest(loop(), smallest=1.0, largest=0.5)


def test_a_simulation_that_is_refused_is_no_oscillation():
    with pytest.raises(ModelError, match="no whole number of steps"):
        largest_stiffness_without_oscillation(
            loop(5e3),
            smallest=100.0,
            largest=1e5,
            kick=1e-3,
            duration=0.1,
            computer=Sampling(period=1e-3, delay=1.05e-3),
        )

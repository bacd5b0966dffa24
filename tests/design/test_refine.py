"""The search for better numbers stays within what keeps the proposal safe."""

from dataclasses import replace

import pytest

from teleopdesign.design import refine
from teleopdesign.design.cancellation import Reason, smoothed_cancellation
from teleopdesign.design.device import Device

pytestmark = pytest.mark.slow  # a whole design


def test_tuning_lowers_the_force_error_within_the_conditions(designed):
    refinement = refine(designed, simulations=25)
    assert refinement.after <= refinement.before
    h, proposed = refinement.force_feedback.names(), designed.force_feedback.controller.names()
    k, b = h["velocity_schedule.gain"], h["velocity_schedule.scheduling_velocity"]
    assert k <= proposed["velocity_schedule.gain"] * (1 + 1e-9)
    c, names = refinement.cancellation.names(), designed.cancellation.controller.names()
    assert c["dahl.level"] == names["dahl.level"]
    assert c["dahl.stiffness"] <= names["dahl.stiffness"] * (1 + 1e-9)
    # the model has no cost of force feedback in fast motion: nothing speaks for a schedule
    assert b > proposed["velocity_schedule.scheduling_velocity"]
    assert "velocity_schedule.gain" in refinement.at_bound


def test_the_error_before_is_the_one_predicted(designed):
    refinement = refine(designed, simulations=4)
    assert refinement.before == pytest.approx(
        designed.prediction.cases["hybrid"].simulated, rel=1e-9
    )


def test_a_smoothed_cancellation_keeps_its_velocity_above_the_encoders(designed):
    level = Reason("level", 0.49, "N", "made for a test")
    device = Device(designed.body, designed.reach, designed.assumptions)
    smoothed = smoothed_cancellation(level, device)
    hybrid = designed.prediction.hybrid.with_block("C", smoothed.controller)
    prediction = replace(designed.prediction, hybrid=hybrid)
    made = replace(designed, cancellation=smoothed, prediction=prediction)
    refinement = refine(made, simulations=25)
    a = smoothed.controller.names()["smoothed_coulomb.smoothing_velocity"]
    assert refinement.cancellation.names()["smoothed_coulomb.smoothing_velocity"] >= a * (1 - 1e-9)
    h = refinement.force_feedback.names()
    k, b = h["velocity_schedule.gain"], h["velocity_schedule.scheduling_velocity"]
    assert b * (1 + k) >= a * k * (1 - 1e-9)


def test_a_design_without_cancellation_tunes_force_feedback_alone(designed):
    prediction = replace(designed.prediction, hybrid=designed.prediction.hybrid.without("C"))
    bare = replace(designed, cancellation=None, prediction=prediction)
    refinement = refine(bare, simulations=6)
    assert refinement.cancellation is None
    assert "velocity_schedule.gain" in refinement.force_feedback.names()

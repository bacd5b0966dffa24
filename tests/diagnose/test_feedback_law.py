"""A command that a controller computes from the motion tells nothing of the device."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.check import check_experiment
from teleopdesign.check.feedback_check import check_feedback
from teleopdesign.diagnose.feedback_law import explain_computed, is_computed

H = 0.01
T = H * np.arange(600)


def moved_by_a_hand(law, *, noise=0.0, hand=False):
    """A handle that a hand moves against the law of a controller; angle in steps of 0.1 mrad."""
    angle = np.round(0.4 * np.sin(2.1 * T) * np.sin(0.7 * T) + 0.1, 4)
    speed = np.round(np.gradient(angle, H), 2)
    random = np.random.default_rng(0)
    torque = np.round(law(angle, speed), 3) + noise * random.standard_normal(len(T))
    table = {"t": T, "q": angle, "w": speed, "u": torque}
    channels = {
        "position": {"column": "q", "unit": "rad"},
        "velocity": {"column": "w", "unit": "rad/s"},
        "actuator_force": "u",
    }
    if hand:
        table["f"] = -torque
        channels["interaction_force"] = "f"
    return td.experiment(table, axis="revolute", inertia=1e-4, **channels)


def spring(angle, speed):
    return 1.5 * (angle - 0.1)


def damper(angle, speed):
    return 0.4 * speed


@pytest.mark.parametrize(
    ("law", "of"), [pytest.param(spring, "position"), pytest.param(damper, "velocity")]
)
def test_a_law_of_the_motion_is_known_to_the_last_digit(law, of):
    other = {"position": "velocity", "velocity": "position"}[of]
    assert is_computed(moved_by_a_hand(law), "device", of=of)
    assert not is_computed(moved_by_a_hand(law), "device", of=other)
    assert not is_computed(moved_by_a_hand(law, noise=0.02), "device", of=of), "a measured force"
    assert not is_computed(moved_by_a_hand(law, hand=True), "device", of=of), "the hand is known"


def test_forces_of_the_position_only_repeat_a_virtual_spring():
    made, effects = moved_by_a_hand(spring), td.effects.EFFECTS
    assert "a controller computes it" in explain_computed(effects["spring"], made, "device")
    assert "a controller computes it" in explain_computed(effects["bias"], made, "device")
    assert explain_computed(effects["stribeck"], made, "device") is None
    measured = moved_by_a_hand(spring, noise=0.02)
    assert explain_computed(effects["spring"], measured, "device") is None


@pytest.mark.parametrize(
    ("law", "words"),
    [
        pytest.param(spring, "no spring, no constant force"),
        pytest.param(damper, "the damping is that of the controller"),
    ],
)
def test_a_check_warns_of_a_law_of_the_motion(law, words):
    (warning,) = check_feedback(moved_by_a_hand(law))
    assert warning.concern == "warning" and words in warning.sentence
    assert not list(check_feedback(moved_by_a_hand(law, noise=0.02)))


@pytest.mark.slow
def test_a_virtual_spring_is_no_spring_of_the_device():
    """`spring` was named with 0.04 % left, beside an inertia of 5e-6 kg m^2."""
    diagnosis = td.find_missing(moved_by_a_hand(spring))
    assert diagnosis.verdict == "undecided" and diagnosis.missing == ()
    assert "the effect repeats this law" in str(diagnosis)
    assert "feedback" in {f.topic for f in check_experiment(diagnosis.experiment)}

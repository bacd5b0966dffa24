"""A command that a controller computes from the motion tells nothing of the device."""

import numpy as np
import pytest
from check.made_channels import ask

import teleopdesign as td
from teleopdesign.diagnose.plausibility import implausible_effects
from teleopdesign.measurement.prepare import prepare

H = 0.01
T = H * np.arange(600)


def moved_by_a_hand(law, *, noise=0.0, hand=False, digits=3):
    """A handle that a hand moves against the law of a controller; angle in steps of 0.1 mrad."""
    angle = np.round(0.4 * np.sin(2.1 * T) * np.sin(0.7 * T) + 0.1, 4)
    speed = np.round(np.gradient(angle, H), 2)
    random = np.random.default_rng(0)
    torque = np.round(law(angle, speed), digits) + noise * random.standard_normal(len(T))
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


def spring_and_damper(angle, speed):
    """As a controller computes it, from the readings of the angle alone."""
    return -1.5 * (angle - 0.1) - 0.05 * np.diff(angle, prepend=angle[0]) / H


def wall(angle, speed):
    return np.where(angle > 0.1, np.minimum(spring_and_damper(angle, speed), 0.0), 0.0)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        pytest.param(spring, "a virtual spring of -1.5 N*m/rad (negative: it pushes away"),
        pytest.param(spring, "no spring, no constant force"),
        pytest.param(damper, "the damping is that of the controller"),
        pytest.param(spring_and_damper, "a virtual spring of 1.5 N*m/rad and damper of 0.05"),
        pytest.param(wall, "neither at rest nor at a limit"),
    ],
)
def test_a_check_warns_of_a_law_of_the_motion(law, words):
    (warning,) = ask("computed_command", moved_by_a_hand(law, digits=5))
    assert warning.concern == "warning" and words in warning.sentence
    assert not ask("computed_command", moved_by_a_hand(law, noise=0.02)), "a measured force"
    assert not ask("computed_command", moved_by_a_hand(law, hand=True)), "the hand is known"


def repeats_the_law(effect, experiment):
    """Whether an effect of the model only repeats the law of a controller."""
    model = td.Model.from_experiment(experiment)
    if effect != "viscous":
        strength = {"spring": {"stiffness": 1.5}, "bias": {"force": 0.1}}[effect]
        model = model.with_effect(effect, values=strength)
    reason = implausible_effects(model, prepare(experiment)).get((effect, "device"), "")
    return "a controller computes it" in reason


@pytest.mark.parametrize("law", [spring, spring_and_damper, wall])
def test_forces_of_the_position_only_repeat_a_virtual_spring(law):
    made = moved_by_a_hand(law, digits=5)
    assert repeats_the_law("spring", made) and repeats_the_law("bias", made)
    assert not repeats_the_law("viscous", made)
    assert not repeats_the_law("spring", moved_by_a_hand(law, digits=5, noise=0.02))
    assert not repeats_the_law("spring", moved_by_a_hand(law, digits=5, hand=True))


@pytest.mark.slow
def test_a_virtual_spring_is_no_spring_of_the_device():
    """`spring` was named with 0.04 % left, beside an inertia of 5e-6 kg m^2."""
    diagnosis = td.find_missing(moved_by_a_hand(spring))
    assert diagnosis.verdict == "undecided" and diagnosis.missing == ()
    assert "the effect repeats this law" in str(diagnosis)
    assert "feedback" in {f.topic for f in td.check_experiment(diagnosis.experiment)}

"""Joints that are called by words: "hip_pos" and "knee_torque" belong to two of them."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, U, look

from teleopdesign.measurement.survey.axes import axis_that_moves, has_sibling, of_another_axis
from teleopdesign.measurement.survey.joint_names import of_another_joint

RANDOM = np.random.default_rng(4)
FORMS = ("{joint}_{of}", "{of}_{joint}", "{joint}.{of}", "/arm/{joint}/{of}", "{joint} {of} #1")


def at_rest(level=0.2, spread=1e-4):
    return level + spread * RANDOM.standard_normal(len(T))


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("words", [("pos", "torque"), ("angle", "current"), ("q", "tau")])
def test_a_joint_that_moves_is_read_with_the_force_of_this_joint(form, words):
    """The force of a joint at rest was taken for that of another one, and both were at rest."""

    def called(joint, of):
        return form.format(joint=joint, of=of)

    position, force = words
    columns = {"time": T}
    columns |= {called(j, position): at_rest() for j in ("pan", "elbow_flex")}
    columns |= {called("knee", position): Q, called("pan", force): at_rest(0.5, 0.01)}
    columns |= {called("elbow_flex", force): at_rest(0.1, 0.02), called("knee", force): U}
    survey = look(columns)
    assert survey.channels["position"]["column"] == called("knee", position)
    assert survey.channels["actuator_force"]["column"] == called("knee", force)
    assert "interaction_force" not in survey.channels
    assert "of another axis" in survey.unused[called("pan", force)]


def test_a_force_that_another_joint_explains_better_is_not_taken():
    """Two joints move alike, and the force of the first one is full of noise."""
    other = 0.8 * np.gradient(Q, T) / np.ptp(np.gradient(Q, T))
    columns = {
        "time": T, "HipAngle": Q, "KneeAngle": 0.9 * Q + 0.1, "KneeTorque": other,
        "HipTorque": U + 0.3 * RANDOM.standard_normal(len(T)),
    }  # fmt: skip
    survey = look(columns)
    assert survey.channels["position"]["column"] == "HipAngle"
    assert survey.channels["actuator_force"]["column"] == "HipTorque"


@pytest.mark.parametrize(
    "names",
    [
        ("q_d", "q_m", "tau_d", "tau_m"),
        ("desired_pos", "actual_pos", "desired_torque", "actual_torque"),
        ("motor_angle", "load_angle", "motor_torque", "load_torque"),
        ("pos_in", "pos_out", "torque_in", "torque_out"),
        ("drive.position", "drive.torque", "cell.force", "cell.temperature"),
        ("hip_pos", "hip_torque", "knee_pos", "ankle_torque"),
    ],
)
def test_words_of_one_joint_are_no_joints(names):
    pairs = [(a, b) for a in names for b in names]
    assert not any(of_another_joint(a, b, names) for a, b in pairs)


def test_numbers_and_words_tell_legs_apart():
    legs = [f"{leg}{k}_{of}" for leg in ("FL", "FR") for k in (0, 1) for of in ("pos", "torque")]
    assert of_another_axis("FL1_pos", "FR1_torque", legs)
    assert of_another_axis("FL0_pos", "FL1_torque", legs)
    assert not of_another_axis("FL1_pos", "FL1_torque", legs)


def test_the_speed_of_another_joint_is_not_that_of_this_one():
    names = [f"{j}_{of}" for j in ("hip", "knee") for of in ("pos", "vel", "torque")]
    assert has_sibling("hip_pos", "knee_vel", names)
    assert not has_sibling("hip_pos", "hip_vel", names)
    travels = {"hip_pos": 0.001, "knee_pos": 1.0}
    assert axis_that_moves("hip_pos", ["knee_pos"], travels, names) == "knee_pos"
    assert axis_that_moves("hip_pos", ["knee_pos"], travels) == "hip_pos", "not of such joints"


@pytest.mark.parametrize("name", ["shoulder_lift.pos", "wrist_lift_joint"])
def test_a_joint_of_a_limb_turns_where_it_lifts(name):
    survey = look({"time": T, name: 60 * Q, "effort": U})
    assert survey.axis == "revolute"
    assert survey.channels["position"]["unit"] == "deg"

"""Arms in files: what a URDF and [model.arm] may say, and one line for what they may not."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from arms.arm_simulator import random_arm, urdf, write_experiment
from hypothesis import given
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.arms import read_urdf
from teleopdesign.base.errors import ExperimentError
from teleopdesign.cli import main

JOINTS = ["axis1", "axis2", "axis3"]


@pytest.fixture
def text():
    return urdf(random_arm(np.random.default_rng(0), 3), inertial=True)


def read(tmp_path, text, joints=JOINTS):
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    return read_urdf(path, "arm.urdf", joints)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("<robot", "<!DOCTYPE r [<!ENTITY a 'b'>]><robot", "found a document type"),
        ("</robot>", "", "not valid XML"),
        ('type="revolute"', 'type="floating"', 'found "floating", expected revolute'),
        ('<child link="link2"/>', '<child link="lnk2"/>', 'no link "lnk2"; did you mean'),
        ('<joint name="axis2"', '<joint name="axis1"', 'joint "axis1" is given twice'),
        ('<mass value="', '<mass value="x', "expected a finite number"),
        ('<mass value="', '<mass value="-', "expected 0 or more"),
        ("robot", "robots", 'found "robots" at the top'),
        ('<axis xyz="0.0 0.0 1.0"/>', '<axis xyz="0 0 0"/>', "axis: found 0 0 0"),
        ('<axis xyz="0.0 0.0 1.0"/>', '<axis xyz="0 inf 1"/>', "expected 3 finite numbers"),
    ],
)
def test_a_bad_urdf_is_one_line(tmp_path, text, before, after, message):
    assert before in text
    with pytest.raises(ExperimentError, match=message) as caught:
        read(tmp_path, text.replace(before, after))
    assert "\n" not in str(caught.value)


@given(st.text(max_size=200))
def test_any_text_is_an_arm_or_one_line(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(content, encoding="utf-8", errors="replace")
    with pytest.raises(ExperimentError):
        read_urdf(path, "arm.urdf", ["axis1"])


def test_joints_in_the_wrong_order_are_answered_with_the_right_one(tmp_path, text):
    with pytest.raises(ExperimentError, match="axis1, axis2, axis3"):
        read(tmp_path, text, ["axis2", "axis1", "axis3"])


def test_a_joint_between_that_moves_must_be_listed(tmp_path, text):
    with pytest.raises(ExperimentError, match='"axis2" moves the arm too'):
        read(tmp_path, text, ["axis1", "axis3"])


def test_links_beyond_fixed_joints_are_carried(tmp_path, text):
    tool = (
        '<link name="tool"><inertial><mass value="2"/><origin xyz="0 0 0.1"/>'
        '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>'
        '<joint name="flange" type="fixed"><parent link="link3"/><child link="tool"/>'
        '<origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/></joint></robot>'
    )
    bare = read(tmp_path, text)
    with_tool = read(tmp_path, text.replace("</robot>", tool))
    added = with_tool.links[2].inertial - bare.links[2].inertial
    # 2 kg at 0.1 m along x of the flange's z: 0.3 m from the last joint
    assert np.allclose(added[:4], [2.0, 0.6, 0.0, 0.0], atol=1e-12)
    assert np.allclose(added[[7, 9]], 2.0 * 0.3**2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    generator = np.random.default_rng(5)
    arm = random_arm(generator, 2)
    return write_experiment(tmp_path_factory.mktemp("made") / "arm", arm, generator, seconds=3.0)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('urdf = "arm.urdf"', 'urdf = "amr.urdf"', 'no file "amr.urdf".*did you mean "arm.urdf"'),
        ('urdf = "arm.urdf"', 'urdf = "../arm.urdf"', "no file"),
        ('urdf = "arm.urdf"', "", "found neither of urdf and"),
        ('urdf_joint = "axis2"', 'urdf_joint = "axs2"', 'no joint "axs2"; did you mean "axis2"'),
        ('estimate = "base parameters"', 'estimate = "base"', 'found "base", expected'),
        ("[model.arm]", "[model.arm]\ngravity = [0, 1]", "expected 3 finite numbers"),
        ("[model.arm]", "[model.arm]\nroot = 1", 'unknown key "root"'),
        ("[model.arm]", '[model.device]\naxis = "revolute"\n[model.arm]', 'unknown key "device"'),
        ('"joint2.position"', '"joint3.position"', 'no quantity "joint3.position"'),
        ("coulomb = {}", "coulombs = {}", 'no effect "coulombs"; did you mean "coulomb"'),
    ],
)
def test_a_bad_description_of_an_arm_is_one_line(tmp_path, folder, before, after, message):
    for file in folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    path = tmp_path / "experiment.toml"
    written = path.read_text()
    assert before in written
    path.write_text(written.replace(before, after, 1))
    with pytest.raises(ExperimentError, match=message) as caught:
        td.Model.from_experiment(td.load_experiment(tmp_path))
    assert "\n" not in str(caught.value)


def test_an_experiment_on_an_arm_pickles_and_says_itself(folder):
    experiment = td.load_experiment(folder)
    assert pickle.loads(pickle.dumps(experiment)) == experiment
    assert "Arm of 2 joints" in repr(experiment)
    model = td.Model.from_experiment(experiment)
    assert pickle.loads(pickle.dumps(model)).parameters == model.parameters


def test_a_command_on_one_joint_asks_for_it_in_one_line(folder, capsys):
    assert main(["describe", str(folder)]) == 2
    output = capsys.readouterr().err.strip().splitlines()
    assert "joint1, joint2: choose one with --body" in output[-1]


def test_the_signals_of_an_arm_are_checked_and_what_is_not_asked_is_reported(folder, capsys):
    assert main(["check", str(folder)]) == 0
    output = " ".join(capsys.readouterr().out.split())
    assert "joint2.actuator_force: no outliers" in output
    assert "not checked which effects the record can show" in output

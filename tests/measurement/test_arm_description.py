"""[model.arm]: what is written becomes the chain, and what is wrong is named with its place."""

import re

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.toml import Table, read_toml
from teleopdesign.measurement.arm_description import arm_from, joints_from

WRITTEN = """
[model.arm]
gravity = [1, -9.7, 2e-1]
[model.arm.joints.slide]
motor_inertia = { value = 250, unit = "g" }
[model.arm.joints.wrist]
[model.arm.joints.wrist.effects]
coulomb = { level = 0.3 }
[[model.arm.links]]
joint = "slide"
kind = "prismatic"
axis = [0, 3, -4]
mass = 2
centre = [0.1, 0.2, 0.3]
inertia = [11, 12, 13, 22, 23, 33]
[[model.arm.links]]
joint = "wrist"
name = "hand"
xyz = [0.4, 0.5, 0.6]
rpy = [1.5707963267948966, 0, 0]
"""


def read(tmp_path, text=WRITTEN, before=None, after=""):
    assert before is None or before in text
    path = tmp_path / "experiment.toml"
    path.write_text(text if before is None else text.replace(before, after, 1))
    return arm_from(read_toml(path, "e.toml").table("model"), tmp_path)


def test_links_that_are_written_out_are_the_chain(tmp_path):
    description, bodies = read(tmp_path)
    slide, wrist = description.arm.links
    assert (slide.name, slide.joint, slide.kind) == ("slide_link", "slide", "prismatic")
    assert (wrist.name, wrist.joint, wrist.kind) == ("hand", "wrist", "revolute")
    assert slide.axis == pytest.approx([0, 0.6, -0.8]) and wrist.axis.tolist() == [0, 0, 1]
    assert slide.origin.tolist() == [0, 0, 0] and wrist.origin.tolist() == [0.4, 0.5, 0.6]
    assert np.array_equal(slide.rotation, np.eye(3))
    # a quarter turn about x carries y to z
    assert wrist.rotation @ [0, 1, 0] == pytest.approx([0, 0, 1])
    assert description.arm.gravity == (1.0, -9.7, 0.2)
    assert description.estimate == "base parameters"
    assert "inertial parameters: base parameters" in repr(description)
    # moments about the origin of the frame, by Steiner: those about the centre, + m (c.c 1 - c c')
    m, c = 2.0, np.array([0.1, 0.2, 0.3])
    about = np.array([[11.0, 12, 13], [12, 22, 23], [13, 23, 33]])
    about += m * (c @ c * np.eye(3) - np.outer(c, c))
    upper = about[np.triu_indices(3)]
    assert slide.inertial == pytest.approx([m, *(m * c), *upper])
    assert not wrist.inertial.any()  # no mass: the inertial parameters are unknown
    assert list(bodies) == ["slide", "wrist"]
    assert bodies["slide"].axis == "prismatic" and bodies["wrist"].axis == "revolute"
    assert bodies["slide"].inertia.in_si("inertia", "prismatic")[0] == pytest.approx(0.25)
    assert bodies["wrist"].inertia is None
    assert bodies["wrist"].effects["coulomb"]["level"].value == 0.3 and not bodies["slide"].effects


def test_gravity_that_is_not_written_points_down_along_z(tmp_path):
    arm = read(tmp_path, before="gravity = [1, -9.7, 2e-1]")[0].arm
    assert arm.gravity == (0.0, 0.0, -9.80665)


@pytest.mark.parametrize("estimate", ["base parameters", "as given"])
def test_how_inertial_parameters_are_treated_is_kept(tmp_path, estimate):
    text = WRITTEN.replace("[model.arm]", f'[model.arm]\nestimate = "{estimate}"')
    assert read(tmp_path, text)[0].estimate == estimate


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('joint = "slide"', 'joint = "wrist"', "found joints wrist, wrist, expected those of"),
        ("axis = [0, 3, -4]", "axis = [0, 0, 0]", "e.toml: model.arm.links[1].axis: found 0, 0, 0"),
        ("axis = [0, 3, -4]", "axis = [0, 3]", "axis: found a list, expected 3 finite numbers"),
        ("axis = [0, 3, -4]", "axis = [0, true, 1]", "expected 3 finite numbers"),
        ("axis = [0, 3, -4]", 'axis = [0, "3", 1]', "expected 3 finite numbers"),
        ("axis = [0, 3, -4]", "axis = [0, nan, 1]", "expected 3 finite numbers"),
        ("22, 23, 33]", "22, 23]", "inertia: found a list, expected 6 finite numbers"),
        ("mass = 2", "mass = -0.5", "mass: found -0.5, expected 0 or more"),
        ("value = 250", "value = -250", "motor_inertia: found -0.25, expected 0 or more"),
        ('kind = "prismatic"', 'kind = "slider"', 'kind: found "slider", expected revolute'),
        ("[model.arm]", '[model.arm]\nestimate = "as give"', 'did you mean "as given"?'),
        (
            "[model.arm]",
            '[model.arm]\nurdf = "a.urdf"',
            "found both of urdf and [[model.arm.links]]",
        ),
        (
            "[model.arm.joints.wrist]\n",
            '[model.arm.joints.wrist]\nurdf_joint = "j2"\n',
            "expected urdf",
        ),
        ("[model.arm]", '[model.arm]\nlink = "x"', 'unknown key "link"'),
        (
            "[model.arm.joints.wrist]\n",
            "[model.arm.joints.wrist]\ninertia = 1\n",
            'unknown key "inertia"',
        ),
        ("[model.arm]\n", "[model.device]\n[model.arm]\n", 'unknown key "device"'),
    ],
)
def test_a_wrong_entry_is_named_with_its_place(tmp_path, before, after, message):
    with pytest.raises(ExperimentError, match=re.escape(message)) as caught:
        read(tmp_path, before=before, after=after)
    assert "\n" not in str(caught.value)


def test_a_mass_and_a_motor_of_zero_are_allowed(tmp_path):
    text = WRITTEN.replace("value = 250", "value = 0").replace("mass = 2", "mass = 0")
    description, bodies = read(tmp_path, text)
    assert bodies["slide"].inertia.value == 0.0 and description.arm.links[0].inertial[0] == 0.0


@pytest.mark.parametrize("name", ["time", "master", "2nd", "a b", "x" * 65])
def test_a_joint_takes_no_name_of_a_channel(name):
    joint = {"axis": "revolute"}
    with pytest.raises(ExperimentError, match="expected a name of letters and digits, none of"):
        joints_from(Table({name: joint}, "e.toml", "model"))
    assert list(joints_from(Table({"x" * 64: joint, "_j-2": joint}, "e.toml"))) == [
        "x" * 64,
        "_j-2",
    ]


def test_an_arm_without_joints_and_one_without_links_are_refused(tmp_path):
    with pytest.raises(ExperimentError, match="arm.joints: found none, expected one table a joint"):
        read(tmp_path, '[model.arm]\nurdf = "a.urdf"')
    with pytest.raises(ExperimentError, match="found neither of urdf and"):
        read(tmp_path, "[model.arm]\n[model.arm.joints.a]")


URDF = """<robot name="r"><link name="base"/><link name="tip"/>
<joint name="j1" type="prismatic"><parent link="base"/><child link="tip"/>
<axis xyz="1 0 0"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>"""


def test_a_urdf_beside_the_experiment_is_read_and_no_other(tmp_path):
    folder = tmp_path / "lab"
    folder.mkdir()
    (tmp_path / "outside.urdf").write_text(URDF)
    for name in ("robot.urdf", "robot2.xml", "notes.txt"):
        (folder / name).write_text(URDF)

    def arm(file, joint='urdf_joint = "j1"'):
        return read(folder, f'[model.arm]\nurdf = "{file}"\n[model.arm.joints.a]\n{joint}')

    description, bodies = arm("robot.urdf")
    assert description.arm.joints == ("j1",) and bodies["a"].axis == "prismatic"
    for file in ("../outside.urdf", "robots.urdf", ".", "a\\u0000b"):
        with pytest.raises(
            ExperimentError, match="no file .* in lab/, found robot.urdf, robot2.xml"
        ):
            arm(file)
    with pytest.raises(ExperimentError, match='did you mean "robot.urdf"'):
        arm("robots.urdf")
    with pytest.raises(ExperimentError, match="lab/robot.urdf"):
        arm("robot.urdf", "")  # no joint "a" in it

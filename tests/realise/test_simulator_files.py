"""Files for simulators hold what was identified, and name what they cannot hold."""

from xml.etree import ElementTree

import pytest

from teleopdesign import EFFECTS, Body, Model
from teleopdesign.realise.simulator_files import ENDINGS, FORMS, as_simulator_file


def with_effects(axis, inertia, **effects):
    body = Body(axis, {"inertia": inertia})
    for name, values in effects.items():
        body = body.with_effect(EFFECTS[name], values)
    return body


@pytest.fixture
def model():
    return Model(
        {
            "master": with_effects(
                "prismatic",
                0.2,
                coulomb={"level": 0.5},
                viscous={"damping": 1.5},
                spring={"stiffness": 30.0},
                stribeck={"extra_static_level": 0.2, "stribeck_velocity": 0.02},
            ),
            "slave": with_effects(
                "revolute",
                4e-4,
                coulomb={"level": 0.01},
                actuator_gain={"gain": 0.6},
                actuator_saturation={"limit": 0.3},
                bias={"force": 0.0},
            ),
        }
    )


def numbers(element):
    return {name: float(value) for name, value in element.attrib.items() if _is_number(value)}


def _is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def test_mjcf_has_a_joint_with_friction_damping_spring_and_armature(model):
    root = ElementTree.fromstring(as_simulator_file(model, "mjcf").text)
    slide, hinge = root.iter("joint")
    assert (slide.get("type"), hinge.get("type")) == ("slide", "hinge")
    expected = {"frictionloss": 0.5, "damping": 1.5, "stiffness": 30.0}
    assert numbers(slide) == pytest.approx(expected | {"armature": 0.1})
    assert numbers(hinge) == pytest.approx({"frictionloss": 0.01, "armature": 2e-4})
    free, limited = root.iter("motor")
    assert free.get("forcerange") is None and limited.get("forcerange") == "-0.5 0.5"
    assert free.get("gear") is None and limited.get("gear") == "0.6"


def test_the_inertia_of_each_mjcf_joint_is_the_identified_one(model):
    root = ElementTree.fromstring(as_simulator_file(model, "mjcf").text)
    slide, hinge = root.iter("body")
    mass = float(slide.find("inertial").get("mass"))
    for one in (slide, hinge):  # about three axes, alike
        assert len(moments := one.find("inertial").get("diaginertia").split()) == 3
        assert len({*moments}) == 1
    moment = float(moments[2])
    assert mass + float(slide.find("joint").get("armature")) == pytest.approx(0.2, rel=1e-8)
    assert moment + float(hinge.find("joint").get("armature")) == pytest.approx(4e-4, rel=1e-8)


def test_urdf_has_links_with_the_inertia_and_joints_with_dynamics(model):
    root = ElementTree.fromstring(as_simulator_file(model, "urdf").text)
    slide, hinge = root.iter("joint")
    assert (slide.get("type"), hinge.get("type")) == ("prismatic", "revolute")
    assert numbers(slide.find("dynamics")) == {"friction": 0.5, "damping": 1.5}
    assert float(hinge.find("limit").get("effort")) == 0.3
    links = {link.get("name"): link for link in root.iter("link")}
    assert set(links) == {"base", "master", "slave"}
    assert float(links["master"].find("inertial/mass").get("value")) == 0.2
    assert float(links["slave"].find("inertial/inertia").get("izz")) == 4e-4


@pytest.mark.parametrize("form", sorted(FORMS))
def test_every_effect_is_held_or_named_as_left_out(form, model):
    file = as_simulator_file(model, form)
    held = {name.rpartition(".")[0] for name, *_ in file.holds}
    for effect, place in model.effects:
        assert (f"{place}.{effect}" in held) != (f"{effect} at {place}" in file.left_out)
    assert "stribeck at master" in file.left_out
    assert "stribeck at master" in file.text and form in ENDINGS


def test_joints_move_along_and_about_their_axis(model):
    """A slide goes along x, a hinge turns about z, in both forms; URDF hangs each on the base."""
    for form in sorted(FORMS):
        root = ElementTree.fromstring(as_simulator_file(model, form).text)
        slide, hinge = root.iter("joint")
        axes = [
            one.get("axis") if form == "mjcf" else one.find("axis").get("xyz")
            for one in (slide, hinge)
        ]
        assert axes == ["1 0 0", "0 0 1"]
    assert [j.find("parent").get("link") for j in (slide, hinge)] == ["base", "base"]
    assert [j.find("child").get("link") for j in (slide, hinge)] == ["master", "slave"]


def test_an_effect_that_is_absent_by_its_value_is_not_written(model):
    """A limit of infinity is none: no motor of the file is limited by it."""
    body = with_effects(
        "revolute", 1e-3, actuator_saturation={"limit": float("inf")}, viscous={"damping": 0.0}
    )
    for form in sorted(FORMS):
        file = as_simulator_file(Model({"joint": body}), form)
        for element in ElementTree.fromstring(file.text).iter():
            assert not {"forcerange", "damping"} & set(element.attrib)
            assert "inf" not in element.attrib.values()
        assert [name for name, *_ in file.holds] == ["joint.inertia"]

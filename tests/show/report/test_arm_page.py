"""The page of an arm: each joint's numbers, the arm's over all joints, and its verdict in words."""

import json
import re
from dataclasses import replace

import pytest

from teleopdesign.diagnose import Diagnosis, LadderRow
from teleopdesign.diagnose.recording import DiagnosedRecording
from teleopdesign.diagnose.statements import EstimatedValue, JointErrors
from teleopdesign.show.report import page_of, write_report

LINKS = {
    "I1zz": EstimatedValue(0.5, 0.01, "kg*m^2"),
    "m2x2": EstimatedValue(0.25, float("nan"), "kg*m"),
}


@pytest.fixture(scope="module")
def two_joints(diagnosis):
    """An arm of two joints, each diagnosed as the rod is; the second with twice the floor."""
    floor = diagnosis.floor
    twice = replace(diagnosis, floor=replace(floor, value=2.0 * floor.value))

    def row(added, check, one, other):
        joints = {"j1": JointErrors(one, one), "j2": JointErrors(other, other)}
        return LadderRow(
            added, 0.5 * check, check, diagnosis.model, 0.0, joints=joints, named=added is not None
        )

    return Diagnosis(
        "effects_missing",
        (row(None, 0.08, 0.07, 0.09), row(diagnosis.rungs[1].added, 0.02, 0.01, 0.03)),
        replace(floor, value=floor.value * (5.0 / 2.0) ** 0.5),
        (),
        (),
        links=LINKS,
        joints={"j1": diagnosis, "j2": twice},
        recording=DiagnosedRecording(stated=diagnosis.experiment),
    )


def test_each_joint_has_separate_errors_and_a_page(two_joints, diagnosis):
    page = page_of(two_joints)
    first, second = page["joints"]
    assert tuple(first[n] for n in ("name", "before", "after")) == ("j1", 0.07, 0.01)
    assert tuple(second[n] for n in ("name", "before", "after")) == ("j2", 0.09, 0.03)
    assert second["floor"] == 2.0 * first["floor"] == 2.0 * diagnosis.floor.value
    assert second["left"] == pytest.approx(0.5 * first["left"]) and first["left"] == diagnosis.left
    alone = page_of(diagnosis)
    assert (first["page"]["parameters"], first["page"]["ladder"]) == (
        alone["parameters"],
        alone["ladder"],
    )
    assert first["sentence"] == "effects_missing: stribeck at device."
    assert (page["before"], page["after"], page["left"]) == (0.08, 0.02, first["left"])
    assert page["floor"] == two_joints.floor.value
    assert (
        page["named"] == ("stribeck",)
        and page["added"] == () == page["parameters"] == page["views"]
    )


@pytest.mark.slow
def test_a_written_page_holds_the_answer_and_every_joint(two_joints, tmp_path):
    path = tmp_path / "arm.html"
    write_report(two_joints, path)
    text = path.read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="teleopdesign-data">(.*?)</script>', text, re.DOTALL)[1])
    assert set(data["answer"]["joints"]) == {"j1", "j2"}
    joints = data["report"]["joints"]
    assert [(j["name"], j["after"]) for j in joints] == [("j1", 0.01), ("j2", 0.03)]
    assert data["report"]["links"][1]["stderr"] is None
    for name in ("j1-ladder", "j2-ladder", "links"):
        assert f'id="{name}"' in text
    # one ladder of the whole arm, and the pictures of the rod's page for each joint
    assert text.count("<img ") == 1 + 2 * 7

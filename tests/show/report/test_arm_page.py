"""The page of an arm: each joint's numbers, the arm's over all joints, and its verdict in words."""

import json
import re
from dataclasses import replace
from types import SimpleNamespace

import pytest

from teleopdesign.base.finding import Finding
from teleopdesign.diagnose import ArmDiagnosis
from teleopdesign.show.report import arm
from teleopdesign.show.report.page import page_of


class MadeArm(ArmDiagnosis):
    """A diagnosis of an arm with made errors; floor, verdict in words and joints are real."""

    base_parameters = {"I1zz": (0.5, 0.01, "kg*m^2"), "m2x2": (0.25, None, "kg*m")}

    def __init__(self, **fields):
        vars(self).update(fields)

    def but(self, **fields):
        return MadeArm(**{**vars(self), **fields})


@pytest.fixture(scope="module")
def two_joints(diagnosis):
    """An arm of two joints, each diagnosed as the rod is; the second with twice the floor."""
    floor = diagnosis.floor
    twice = replace(diagnosis, floor=replace(floor, value=2.0 * floor.value))

    def fit(check, one, other):
        errors = {"j1": one, "j2": other}
        return SimpleNamespace(fit_error=0.5 * check, check_error=check, check_errors=errors)

    added = diagnosis.rungs[1].added
    rungs = (
        SimpleNamespace(added=None, title="", fit=fit(0.08, 0.07, 0.09)),
        SimpleNamespace(added=added, title=str(added), fit=fit(0.02, 0.01, 0.03)),
    )
    return MadeArm(
        experiment=diagnosis.experiment,
        prepared=diagnosis.prepared,
        verdict="effects_missing",
        rungs=rungs,
        joints={"j1": diagnosis, "j2": twice},
    )


def test_each_joint_has_separate_errors_and_a_page(two_joints, diagnosis):
    page = arm.arm_page_of(two_joints)
    first, second = page.joints
    assert (first.name, first.before, first.after) == ("j1", 0.07, 0.01)
    assert (second.name, second.before, second.after) == ("j2", 0.09, 0.03)
    assert second.floor == 2.0 * first.floor == 2.0 * diagnosis.floor.value
    assert second.left == pytest.approx(0.5 * first.left) and first.left == diagnosis.left
    arm_page = page_of(diagnosis)
    assert first.page.parameters == arm_page.parameters and first.page.ladder == arm_page.ladder
    assert first.sentence == "effects_missing: stribeck at device."
    assert (page.before, page.after, page.left) == (0.08, 0.02, first.left)
    # root of the mean square of one floor and of twice it
    assert page.floor == pytest.approx(first.floor * (5.0 / 2.0) ** 0.5)
    assert page.named == ("stribeck",) and page.added == ()


def test_findings_on_what_is_left_stand_at_their_joint(two_joints):
    one = Finding("topic", "note", "rises with speed")
    page = arm.arm_page_of(two_joints, unexplained={"j2": [one]}, soundness=[one, one])
    assert [j.page.unexplained for j in page.joints] == [(), (one,)]
    assert page.soundness == (one, one)


def test_the_ladder_of_an_arm_counts_errors_in_its_floor(two_joints):
    rows = arm.arm_page_of(two_joints).ladder
    assert [r.name for r in rows] == ["your model, re-estimated", "stribeck at device"]
    assert [r.brief for r in rows] == ["your model", "stribeck"]
    assert [(r.fit_error, r.check_error) for r in rows] == [(0.04, 0.08), (0.01, 0.02)]
    assert [two_joints.floor * r.floors for r in rows] == pytest.approx([0.08, 0.02])


def test_base_parameters_come_with_their_errors_and_units(two_joints):
    rows = arm.arm_page_of(two_joints).links
    assert [(r.name, r.unit, r.value, r.stderr) for r in rows] == [
        ("I1zz", "kg*m^2", 0.5, 0.01),
        ("m2x2", "kg*m", 0.25, None),
    ]


def test_the_verdict_on_an_arm_names_what_is_missing_or_that_nothing_is(two_joints):
    sentence = arm._verdict(two_joints)
    assert sentence.startswith("Your model of the arm lacks stribeck at device. With all")
    assert "falls from 8.00\u202f% to 2.00\u202f%" in sentence
    adequate = arm._verdict(two_joints.but(verdict="model_adequate"))
    assert "is adequate: it leaves 2.00\u202f%" in adequate
    undecided = arm._verdict(two_joints.but(verdict="undecided"))
    assert undecided.startswith("Undecided: with stribeck at device the force error")
    nothing = arm._verdict(two_joints.but(verdict="undecided", rungs=two_joints.rungs[:1]))
    assert "no candidate effect explains the 8.00\u202f%" in nothing


@pytest.mark.slow
def test_a_written_page_holds_the_answer_and_every_joint(two_joints, monkeypatch, tmp_path):
    monkeypatch.setattr(arm, "arm_answer", lambda _: {"verdict": "effects_missing"})
    path = tmp_path / "arm.html"
    arm.write_arm_report(two_joints, path)
    text = path.read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="teleopdesign-data">(.*?)</script>', text, re.DOTALL)[1])
    assert data["answer"] == {"verdict": "effects_missing"}
    joints = data["report"]["joints"]
    assert [(j["name"], j["after"]) for j in joints] == [("j1", 0.01), ("j2", 0.03)]
    assert data["report"]["links"][1]["stderr"] is None
    for name in ("j1-ladder", "j2-ladder", "links"):
        assert f'id="{name}"' in text
    # one ladder of the whole arm, and the pictures of the rod's page for each joint
    assert text.count("<img ") == 1 + 2 * 6

"""The study of arms: which arms it draws, and what counts as right there."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from _scoring import Answer, judge
from hidden_in_arms import JOINTS, Case, plan

sys.path.append(str(Path(__file__).resolve().parents[1] / "arms"))


def test_every_number_of_joints_meets_a_hidden_effect_and_none_at_joints_that_are_there():
    cases = plan(90, 1)
    for count in set(JOINTS):
        mine = [c for c in cases if c.joints == count]
        assert any(c.hidden is None for c in mine)
        hidden = [c.hidden for c in mine if c.hidden is not None]
        assert hidden and all(0 <= joint < count for _, joint, _ in hidden)
    assert {c.late == 0.0 for c in cases if c.hidden is None} == {True, False}


@pytest.mark.parametrize(
    ("named", "groups", "outcome"),
    [
        ((("bias", "joint2"),), (), "right"),
        ((("bias", "joint1"),), (), "other place"),
        ((), ((("bias", "joint2"), ("coulomb_asymmetry", "joint2")),), "look-alike"),
        ((), ((("bias", "joint2"), ("spring", "joint2")),), "wide group"),
        ((("bias", "joint2"), ("spring", "joint1")), (), "right first"),
    ],
)
def test_right_is_that_effect_at_that_joint_alone(named, groups, outcome):
    truth = Case(0, 2, ("bias", 1, 1.0)).truth
    listed = tuple(frozenset(g) for g in groups)
    verdict = "effects_missing" if named else "undecided"
    assert judge(truth, Answer(verdict, named, listed, {}, {})) == outcome

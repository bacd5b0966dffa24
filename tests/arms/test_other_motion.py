"""A motor that also pushes another joint: the coupling is named, and none where there is none."""

from __future__ import annotations

import json

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.diagnose.answer import load_answer, write_answer
from teleopdesign.diagnose.search_plan import QUICK

pytestmark = pytest.mark.slow  # a diagnosis of an arm

SECONDS = 10.0
AMONG = ("coupling", "spring", "quadratic_drag")


def made(place, hidden, joints=3):
    generator = np.random.default_rng(11)
    arm = random_arm(generator, joints)
    return write_experiment(place, arm, generator, hidden, seconds=SECONDS)


@pytest.fixture(scope="module")
def coupled(tmp_path_factory):
    """The motor of joint 2 pushes joint 1, and joint 1 does not push joint 2."""
    return made(tmp_path_factory.mktemp("coupled") / "arm", ("coupling", 0, 1.0))


def test_a_coupling_of_motors_is_named_at_its_joint_with_the_one_that_acts(coupled, tmp_path):
    experiment = td.load_experiment(coupled)
    diagnosis = td.find_missing(experiment, plan=QUICK, among=AMONG)
    # at the other joint with the other sign it is the same, for links that nobody knows may couple
    # the two both ways: that is said
    (named,) = diagnosis.missing
    other = {"joint1": "joint2", "joint2": "joint1"}[named.at]
    assert named.effect.name == "coupling"
    assert f"coupling at {named.at} by the motion of {other}" in repr(diagnosis)
    assert f"coupling at {other} by the motion of {named.at} leaves" in repr(diagnosis)
    path = tmp_path / "answer.json"
    write_answer(diagnosis, path)
    content = json.loads(path.read_text())
    assert content["missing"] == [{"effect": "coupling", "at": named.at, "follows": other}]
    assert content["other_motion"][named.at] == other
    again = load_answer(path, experiment=experiment)
    assert again == diagnosis and repr(again) == repr(diagnosis)
    content["other_motion"] = {"joint1": "joint7"}
    path.write_text(json.dumps(content))
    with pytest.raises(ExperimentError, match='other_motion: no joint "joint7", has joint1'):
        load_answer(path, experiment=experiment).joints["joint1"].prepared  # noqa: B018


def test_no_coupling_is_named_where_none_is(tmp_path):
    diagnosis = td.find_missing(
        td.load_experiment(made(tmp_path / "arm", None)), plan=QUICK, among=("coupling",)
    )
    assert diagnosis.verdict == "model_adequate"
    assert diagnosis.missing == () and len(diagnosis.rungs) == 1

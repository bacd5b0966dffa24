"""From the answer on an arm: its diagnosis read back, its page, and one joint taken out of it."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.cli import main
from teleopdesign.diagnose.answer import load_answer, write_answer
from teleopdesign.diagnose.learnable import learnable
from teleopdesign.diagnose.parts import inertias_at, prepare_parts
from teleopdesign.diagnose.predictions import write_predictions
from teleopdesign.diagnose.search import estimate_from_starts
from teleopdesign.diagnose.search_plan import QUICK
from teleopdesign.show.report import write_report

pytestmark = pytest.mark.slow  # diagnoses of arms

SECONDS = 10.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    generator = np.random.default_rng(5)
    place = tmp_path_factory.mktemp("arm") / "two"
    hidden = ("spring", 1, 1.0)
    return write_experiment(place, random_arm(generator, 2), generator, hidden, seconds=SECONDS)


@pytest.fixture(scope="module")
def diagnosis(folder) -> td.Diagnosis:
    """The diagnosis where only what is hidden, and one more, are tried."""
    return td.find_missing(
        td.load_experiment(folder), plan=QUICK, among=("spring", "quadratic_drag")
    )


@pytest.fixture(scope="module")
def answer(folder, diagnosis) -> Path:
    path = folder.parent / "answer.json"
    write_answer(diagnosis, path)
    return path


def test_the_diagnosis_reads_back_as_it_was(diagnosis, answer, tmp_path):
    document = json.loads(answer.read_text())
    assert document["missing"] == [{"effect": "spring", "at": "joint2"}]
    again = load_answer(answer)
    assert again == diagnosis and repr(again) == repr(diagnosis)
    for name, one in (("memory", diagnosis), ("answer", again)):
        write_report(one, tmp_path / f"{name}.html")
        write_predictions(one, tmp_path / f"{name}.csv")
    for ending in ("html", "csv"):
        files = [(tmp_path / f"{name}.{ending}").read_bytes() for name in ("memory", "answer")]
        assert files[0] == files[1]
    # a notebook shows the ladder and what is said of each joint
    shown = again._repr_html_()
    ElementTree.fromstring(shown)
    assert "+ spring at joint2" in shown and "joint1: " in shown


def test_a_force_by_another_joint_s_motion_is_learned_from_that_motion_only(folder):
    """What is added to the command of joint 2 follows the place of joint 1."""
    experiment = td.load_experiment(folder)
    prepared = prepare_parts(experiment)
    beside = prepared.beside("joint2")
    stretches = []
    for stretch, (other,) in zip(prepared.parts["joint2"].stretches, beside, strict=True):
        motion = stretch.motion
        pushed = motion.command + 3.0 * np.sign(other.position)
        stretches.append(replace(stretch, motion=replace(motion, command=pushed)))
    records = replace(prepared.parts["joint2"], stretches=tuple(stretches))
    model = td.Model({"joint2": td.Model.from_experiment(experiment).bodies["joint2"]})
    fit = estimate_from_starts(model.with_links(prepared.initial), records)
    with_other = learnable(fit.model, records, beside=beside)
    by_itself = learnable(fit.model, records)
    assert with_other is not None and by_itself is not None
    assert with_other.left == by_itself.left
    assert with_other.part > 2.0 * by_itself.part


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("describe", "of the force"),
        ("export --to urdf", "joint2.coulomb.level"),
        ("next", "next experiment"),
        (
            "passivity --dahl 0.5 2000 --pose joint1=20deg",
            "largest compensator level f_D for passivity",
        ),
    ],
)
def test_one_joint_is_taken_from_the_answer(
    answer, capsys, command, message, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    name, *rest = command.split()
    output = ["--output", "joint.urdf"] if name == "export" else []
    assert main([name, str(answer), "--body", "joint2", *rest, *output]) == 0
    assert message in capsys.readouterr().out


def test_the_body_of_a_joint_has_the_inertia_of_the_final_links(folder, answer):
    """The first links, without the spring, were wrong by more than that."""
    model, experiment = load_answer(answer).model, td.load_experiment(folder)
    poses = np.array([experiment.records[0].signals[f"joint{k}.position"][::20] for k in (1, 2)])
    expected = inertias_at(experiment, model.links, poses).mean(axis=1)
    for k, joint in enumerate(("joint1", "joint2")):
        assert model.parameters[f"{joint}.inertia"].value == pytest.approx(expected[k], rel=0.02)


@pytest.mark.parametrize("pose", ["joint3=1", "joint1=fast", "joint1=1m"])
def test_a_bad_pose_is_one_line(answer, capsys, pose):
    arguments = ["--to", "urdf", "--body", "joint1", "--pose", pose, "--output", "x.urdf"]
    assert main(["export", str(answer), *arguments]) == 2
    output = capsys.readouterr().err.strip()
    assert f"--pose {pose}" in output and "\n" not in output

"""Files that earlier versions wrote: an answer and an older one, an experiment, a diagram."""

from pathlib import Path

import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError

SAVED = Path(__file__).parent / "saved_files"


def test_an_experiment_and_a_diagram_load():
    experiment = td.load_experiment(SAVED / "rod")
    assert [len(r.time) for r in experiment.records] == [2000, 1333]
    assert experiment.bodies["device"].axis == "prismatic"
    diagram = td.read_diagram(SAVED / "interface.toml")
    assert {b.name for b in diagram.blocks} >= {"Z_M", "C"}


def test_an_answer_loads_as_the_diagnosis_that_it_was():
    diagnosis = td.load_answer(SAVED / "answer.json")
    assert [str(c) for c in diagnosis.missing] == ["stribeck at device"]
    assert diagnosis.experiment == td.load_experiment(SAVED / "rod")
    text = str(diagnosis)
    for line in (
        "(your model, re-estimated)                     3.55%          7.14%",
        "+ stribeck at device                           0.77%          1.13%",
        "      stribeck_velocity = 0.0230 +- 0.0019 m/s",
        "black box: 1.1 % left; nothing was learned from the motion",
        "verdict: effects_missing: stribeck at device.",
    ):
        assert line in text.splitlines()
    # its models leave what it states along the records of the folder that it names
    left = diagnosis.fit(diagnosis.model)
    assert left.check_error == pytest.approx(diagnosis.after.check_error, rel=1e-9)
    assert diagnosis.questions == ()


def test_of_an_older_answer_the_final_model_is_there():
    diagnosis, older = (td.load_answer(SAVED / f"{n}.json") for n in ("answer", "older_answer"))
    values = {n: v.value for n, v in diagnosis.model.parameters.items()}
    assert {n: v.value for n, v in older.model.parameters.items()} == values
    assert (older.verdict, older.left) == (diagnosis.verdict, diagnosis.left)
    for more in ("questions", "experiment"):
        with pytest.raises(ExperimentError, match="earlier version|does not say where"):
            getattr(older, more)
    design = td.load_answer(
        SAVED / "older_answer.json", experiment=td.load_experiment(SAVED / "rod")
    )
    assert design.model.parameters["device.inertia"].fixed is False


def test_an_answer_on_an_arm_loads_with_its_joints_and_links():
    diagnosis = td.load_answer(SAVED / "arm.json")
    assert [str(c) for c in diagnosis.missing] == ["spring at joint2"]
    assert set(diagnosis.joints) == {"joint1", "joint2"} == set(diagnosis.model.bodies)
    assert len(diagnosis.links) == len(diagnosis.model.links) > 0
    assert "joint2: verdict: effects_missing: spring at joint2." in str(diagnosis)

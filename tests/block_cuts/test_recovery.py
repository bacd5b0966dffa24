"""What is planted in a simulated interface is named at its block, and nothing else is."""

import json
from dataclasses import replace

import numpy as np
import pytest
from block_cuts.interface_simulator import draw_interface, leave_out, write_case

import teleopdesign as td
from teleopdesign.block_cuts import write_answer
from teleopdesign.unexplained import describe_residual


def diagnosis_of(folder, hidden, seed, at="R_A", without=None):
    random = np.random.default_rng(seed)
    interface = replace(draw_interface(random), hidden=hidden)
    write_case(interface, folder, random, durations=(3.0, 2.5))
    if without is not None:
        leave_out(folder, without)
    return td.find_missing(td.load_experiment(folder), at=[at])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "at", "value"),
    [("delay", "H", 0.004), ("gain", "computer", 1.05), ("velocity_filter", "C", 0.006)],
)
def test_an_effect_of_the_computer_is_named_at_its_block_with_its_value(
    effect, at, value, tmp_path
):
    diagnosis = diagnosis_of(tmp_path, {(effect, at): value}, seed=5)
    assert diagnosis.missing == ((effect, at),)
    # rounding of the command to 4 mN is all that is left
    assert diagnosis.left["R_A"] < 1.3
    (candidate,) = [
        c for c in diagnosis.answer()["candidates"] if (c["effect"], c["at"]) == (effect, at)
    ]
    (parameter,) = candidate["parameters"].values()
    assert parameter["value"] == pytest.approx(value, rel=0.02)
    assert candidate["probability"] > 0.9


@pytest.mark.slow
def test_without_the_command_an_effect_of_a_law_is_named_along_the_motion(tmp_path):
    place = tmp_path / "case"
    diagnosis = diagnosis_of(place, {("delay", "H"): 0.004}, 5, at="Z_M", without="R_A")
    assert diagnosis.missing == (("delay", "H"),)
    ((delay, error),) = diagnosis.placed
    # a row of the log is 1 ms: a part of one belongs to the clock
    assert delay.value == pytest.approx(0.004, abs=0.0005)
    assert error < 0.0005
    assert diagnosis.left["Z_M"] < 1.8
    body = diagnosis.bodies["Z_M"]
    (part,) = describe_residual(body.model, body.prepared, body.floor).parts
    # the predicted command stands above the line alone
    assert part.error == pytest.approx(diagnosis.rows[-1].check["Z_M"], rel=1e-6)
    write_answer(diagnosis, tmp_path / "answer.json")
    again = td.load_answer(tmp_path / "answer.json")
    assert again.missing == diagnosis.missing
    assert again.rows == diagnosis.rows
    assert str(again) == str(diagnosis)


@pytest.mark.slow
def test_without_the_command_an_effect_of_the_body_is_none_of_the_laws(tmp_path):
    hidden = {("quadratic_drag", "Z_M"): 6.0}
    diagnosis = diagnosis_of(tmp_path / "case", hidden, 5, at="Z_M", without="R_A")
    assert diagnosis.missing == (("quadratic_drag", "Z_M"),)
    body, (before, after) = diagnosis.bodies["Z_M"], diagnosis.rows
    assert before.check["Z_M"] == body.before.check_error
    assert after.check["Z_M"] == body.after.check_error
    write_answer(diagnosis, tmp_path / "answer.json")
    assert td.load_answer(tmp_path / "answer.json").rows == diagnosis.rows


@pytest.mark.slow
def test_a_free_parameter_of_a_law_absorbs_the_gain(tmp_path):
    random = np.random.default_rng(5)
    interface = replace(draw_interface(random), hidden={("gain", "H"): 1.06})
    write_case(interface, tmp_path, random, durations=(3.0, 2.5))
    gain = interface.values["h_gain"]
    text = (tmp_path / "interface.toml").read_text()
    assert text.count(f"gain = {gain},") == 1
    free = text.replace(f"gain = {gain},", f"gain = {{ value = {gain}, fixed = false }},")
    (tmp_path / "interface.toml").write_text(free)
    experiment = td.load_experiment(tmp_path)
    td.write_diagram(experiment.diagram, tmp_path / "again.toml")
    assert td.read_diagram(tmp_path / "again.toml") == experiment.diagram
    answer = td.find_missing(experiment, at=["R_A"]).answer()
    assert answer["verdict"] == "model_adequate"
    value = answer["model_parameters"]["H.velocity_schedule.gain"]
    assert value["value"] == pytest.approx(1.06 * gain, rel=0.01)


@pytest.fixture(scope="module")
def adequate(tmp_path_factory):
    return diagnosis_of(tmp_path_factory.mktemp("adequate"), {}, seed=6)


@pytest.mark.slow
def test_nothing_is_named_where_nothing_is_planted(adequate):
    assert adequate.verdict == "model_adequate" and not adequate.missing


@pytest.mark.slow
def test_a_constant_that_any_block_may_have_added_is_listed_at_all_of_them(tmp_path):
    diagnosis = diagnosis_of(tmp_path / "case", {("bias", "H"): 0.02}, seed=7)
    assert diagnosis.verdict == "undecided"
    (group,) = diagnosis.groups
    assert set(group) == {("bias", "H"), ("bias", "C"), ("bias", "computer")}
    write_answer(diagnosis, tmp_path / "answer.json")
    answer = json.loads((tmp_path / "answer.json").read_text())
    errors = [row["check_error"] for row in answer["ladder"]]
    assert errors == sorted(errors, reverse=True)
    assert set(answer["ladder"][-1]["cuts"]) == set(answer["floors"]) == {"R_A"}
    assert answer["assumed"] == {"R_V": 0.0} and answer["check"] == "records"
    assert set(answer["untested"]) == {"Z_M", "Z_H"}

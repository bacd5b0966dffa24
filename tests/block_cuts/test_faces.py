"""Every verb takes a whole diagram: compare, rank, describe, design, and a saved answer."""

import numpy as np
import pytest
from block_cuts.interface_simulator import draw_interface, write_case

import teleopdesign as td
from teleopdesign.block_cuts import write_answer
from teleopdesign.cli import main
from teleopdesign.diagnose.search_plan import QUICK

LATE = 0.003


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place, random = tmp_path_factory.mktemp("faces") / "interface", np.random.default_rng(12)
    interface = draw_interface(random)
    interface.hidden = {("delay", "computer"): LATE}
    write_case(interface, place, random, durations=(2.5, 2.0))
    return place


@pytest.fixture(scope="module")
def diagnosis(folder):
    return td.find_missing(td.load_experiment(folder), among={"viscous", "bias"}, plan=QUICK)


def test_stated_laws_are_compared_without_estimation(folder):
    experiment = td.load_experiment(folder)
    made = td.compare(experiment)
    assert set(made) == {"Z_M", "Z_H", "R_A"}
    assert made["R_A"].errors["check"]["R_A"] > 0.02
    assert made["Z_H"].check_error > 0.05  # values of the file are up to 15 % off


@pytest.mark.slow
def test_a_saved_answer_is_the_diagnosis_that_was_written(diagnosis, folder, capsys):
    assert diagnosis.missing == (("delay", "computer"),)
    path = folder / "saved.json"
    write_answer(diagnosis, path)
    again = td.load_answer(path)
    assert repr(again) == repr(diagnosis)
    first, second = diagnosis.answer(), again.answer()
    for key in ("verdict", "missing", "ladder", "indistinguishable", "floors", "untested"):
        assert first[key] == second[key], key
    with pytest.raises(td.ExperimentError, match="whole diagram"):
        td.load_answer(path, experiment=td.load_experiment(td.example("rod")))
    assert main(["report", str(path)]) == 0
    assert "<svg" in path.with_suffix(".html").read_text()
    assert main(["next", str(path)]) == 0
    assert "delay at computer" in capsys.readouterr().out
    assert main(["describe", str(path), "--as-is"]) == 2
    assert "whole diagram" in capsys.readouterr().err


@pytest.mark.slow
def test_every_cut_has_a_ranking_and_every_body_a_description(folder):
    experiment = td.load_experiment(folder)
    ranked = td.rank(experiment)
    assert set(ranked) == {"Z_M", "Z_H", "R_A"}
    assert ranked["R_A"].accepted.added.key == ("delay", "computer")
    assert set(td.describe(experiment)) == {"Z_M", "Z_H"}


@pytest.mark.slow
def test_the_commands_describe_and_design_take_a_saved_answer(diagnosis, folder, tmp_path, capsys):
    path = tmp_path / "saved.json"
    write_answer(diagnosis, path)
    described = tmp_path / "left.json"
    assert main(["describe", str(path), "--json", str(described)]) == 0
    text = capsys.readouterr().out
    assert "\nZ_M\n" in text and "\nZ_H\n" in text and described.is_file()
    assert main(["design", str(path), "--output", str(tmp_path / "made")]) == 0
    assert "expected force error" in capsys.readouterr().out
    assert (tmp_path / "made").is_dir() and any((tmp_path / "made").iterdir())

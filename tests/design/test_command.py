"""`teleopdesign design`: from a folder to controllers, on the rod, simulated cases, recordings."""

import json
import tomllib

import numpy as np
import pytest
from few_effects import FEW
from shared_data import shared_folder

import teleopdesign as td
from teleopdesign.cli import main


def test_a_folder_that_cannot_be_made_is_one_line(rod_answer, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    out = tmp_path / "file" / "out"
    arguments = ["design", str(td.example("rod")), "--answer", str(rod_answer)]
    assert main([*arguments, "--output", str(out)]) == 2
    assert capsys.readouterr().err == f"teleopdesign: {out}: Not a directory\n"


def designs(path):
    return json.loads(path.read_text())["bodies"]


@pytest.mark.slow
def test_an_answer_leads_to_a_design_and_its_files(rod_answer, tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["design", str(td.example("rod")), "--answer", str(rod_answer)]
    assert main([*arguments, "--json", str(tmp_path / "d.json"), "--output", str(out)]) == 0
    assert "MBC: proved: Coulomb friction" in capsys.readouterr().out
    assert {p.name for p in out.iterdir()} == {
        f"device_{n}" for n in
        ("design.json", "design.pdf", "design.svg", "design.png", "interface.toml")
    }  # fmt: skip
    table = tomllib.loads((out / "device_interface.toml").read_text())
    made = designs(tmp_path / "d.json")["device"]
    assert [table["blocks"]["C"]["law"]] == made["cancellation"]["laws"]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--body", "devise"], '--body: no body "devise", has device; did you mean "device"?'),
        (["--fraction", "1.5"], "design: fraction: found 1.5, expected above 0, at most 1"),
        (["--answer", "nothing.json"], "nothing.json: cannot be read: No such file or directory"),
        (["--json", "design.txt"], "design.txt: found '.txt', expected .json"),
    ],
)
def test_a_mistake_is_one_line(more, message, capsys):
    assert main(["design", str(td.example("rod")), *more]) == 2
    assert capsys.readouterr().err == f"teleopdesign: {message}\n"


def written_case(folder, effect, kind="device"):
    """A simulated case of tests/hidden, and its truth."""
    from cases import make_case, write_case

    case = make_case(np.random.default_rng(8), "clear", [effect], kind)
    write_case(case, folder)
    return json.loads((folder / "truth.json").read_text())


@pytest.mark.slow
def test_a_simulated_device_with_a_hidden_effect(choose_from, tmp_path):
    choose_from((*FEW, "coulomb_asymmetry", "bias"))
    truth = written_case(tmp_path / "case", "coulomb_asymmetry")
    assert main(["design", str(tmp_path / "case"), "--json", str(tmp_path / "d.json")]) == 0
    made = designs(tmp_path / "d.json")["device"]
    level = truth["model_parameters"]["device.coulomb.level"]
    # by the truth, no more than the level is cancelled
    stated = made["cancellation"]["parameters"].items()
    (cancelled,) = (p["value"] for name, p in stated if name.endswith(".level"))
    assert cancelled <= level
    assert made["passivity"]["MBC"][0]["status"] == "proved"


@pytest.mark.slow
def test_each_body_of_a_teleoperator_is_a_separate_device(few, tmp_path):
    written_case(tmp_path / "case", "stribeck", "teleoperator")
    assert main(["design", str(tmp_path / "case"), "--json", str(tmp_path / "d.json")]) == 0
    made = designs(tmp_path / "d.json")
    assert list(made) == ["master", "slave"]
    for one in made.values():
        errors = {case: p["simulated"] for case, p in one["prediction"].items()}
        assert errors["hybrid"] < errors["none"]


@pytest.mark.slow
def test_a_real_recording_leads_to_a_design(choose_from, tmp_path):
    """Among effects that a drive may have; tests of `diagnose` choose from all."""
    choose_from((*FEW, "presliding", "bias", "coulomb_asymmetry"))
    folder = shared_folder("data") / "emps"
    assert main(["design", str(folder), "--json", str(tmp_path / "d.json")]) == 0
    made = designs(tmp_path / "d.json")["device"]
    errors = {case: p["simulated"] for case, p in made["prediction"].items()}
    assert errors["hybrid"] <= errors["MBC"] <= errors["none"]
    assert made["cancellation"] is not None
    assert made["passivity"]["MBC"][0]["status"] == "proved"

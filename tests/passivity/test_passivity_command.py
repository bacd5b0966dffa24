"""`teleopdesign passivity`: claims, margins and certificates for a diagnosed device."""

import json

import pytest

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.cli import main
from teleopdesign.passivity.identified import identify_device


def number(value, stderr, unit):
    return {"value": value, "stderr": stderr, "unit": unit}


@pytest.fixture
def answer(tmp_path):
    """An answer: 0.5 N of friction known to 0.01 N, that gives with 20 000 N/m known to 500."""
    path = tmp_path / "answer.json"
    content = {
        "verdict": "effects_missing",
        "noise_floor": 0.02,
        "indistinguishable": [],
        "ladder": [
            {"added": None, "fit_error": 0.2, "check_error": 0.2},
            {
                "added": {"effect": "presliding", "at": "device"},
                "fit_error": 0.02,
                "check_error": 0.02,
            },
        ],
        "missing": [{"effect": "presliding", "at": "device"}],
        "model_parameters": {
            "device.inertia": number(0.15, 0.001, "kg"),
            "device.coulomb.level": number(0.5, 0.01, "N"),
            "device.viscous.damping": number(2.0, 0.05, "N*s/m"),
        },
        "candidates": [
            {
                "effect": "presliding",
                "at": "device",
                "probability": 0.9,
                "check_error": 0.02,
                "parameters": {"stiffness": number(2e4, 500.0, "N/m")},
            },
            {
                "effect": "bias",
                "at": "device",
                "probability": 0.1,
                "check_error": 0.2,
                "parameters": {"force": number(1, 1, "N")},
            },
        ],
    }
    path.write_text(json.dumps(content))
    return path


def claims_of(path):
    return {c["topic"]: c for c in json.loads(path.read_text())["claims"]}


@pytest.mark.slow
def test_a_compensator_within_all_intervals_is_proved(answer, tmp_path, capsys):
    out = tmp_path / "claims.json"
    assert main(["passivity", str(answer), "--dahl", "0.47", "1.8e4", "--json", str(out)]) == 0
    claims = claims_of(out)
    assert claims["estimate"]["status"] == claims["95 % interval"]["status"] == "proved"
    assert claims["search by simulation"]["status"] == "evidence"
    text = capsys.readouterr().out
    # 0.5 - 1.96 * 0.01 N
    assert (
        "largest compensator level f_D for passivity at every level in the interval: 0.4804 N"
        in text
    )
    assert main(["passivity", "--check", str(out)]) == 0
    assert "2 certificates of 3 claims verified" in capsys.readouterr().out


def test_the_estimate_may_be_passive_where_the_interval_is_not(answer, tmp_path):
    out = tmp_path / "claims.json"
    assert main(["passivity", str(answer), "--dahl", "0.49", "1.5e4", "--json", str(out)]) == 0
    claims = claims_of(out)
    assert claims["estimate"]["status"] == "proved"
    assert claims["95 % interval"]["status"] == "refuted"
    assert claims["95 % interval"]["motion"]["energy"] > 0
    assert claims["95 % interval"]["replayed"]["energy"] > 0


def without_presliding(content, left, verdict="undecided"):
    content["ladder"], content["missing"] = content["ladder"][:1], []
    content["candidates"] = content["candidates"][1:]
    floor = content["ladder"][-1]["check_error"] / left
    return content | {"verdict": verdict, "noise_floor": floor}


def cell(low, way, samples, least):
    ends = {"low": low, "high": low + 0.01, "direction": way}
    return ends | {"samples": samples, "least": least}


CELLS = [cell(0.0, 1, 40.0, 0.41), cell(0.0, -1, 25.0, 0.44), cell(0.01, 1, 30.0, 0.30),
         cell(0.01, -1, 4.0, None)]  # fmt: skip


def text_of(path, content, capsys, *options):
    path.write_text(json.dumps(content))
    code = main(["passivity", str(path), *options])
    return code, capsys.readouterr()


def test_the_limit_of_an_undecided_answer_is_that_of_its_cells_and_says_so(
    answer, tmp_path, capsys
):
    content = without_presliding(json.loads(answer.read_text()), 12.8)
    out = tmp_path / "claims.json"
    cells = {"friction_cells": {"device": CELLS}}
    options = ["--dahl", "0.35", "1.5e4", "--json", str(out)]
    code, text = text_of(answer, content | cells, capsys, *options)
    first = text.out.splitlines()[0]
    assert code == 0
    for word in ("undecided", "unexplained force", "12.8 noise floors", "3 of 4 cells"):
        assert word in first
    assert first.endswith("not covered: backward 0.01 to 0.02 m")
    assert "covered cells: 0.3 N" in text.out and "at the estimates" not in text.out
    assert json.loads(out.read_text())["margins"][0]["value"] == 0.3
    # 0.35 N is below the level of the model, 0.48 N, and above the friction that was seen
    assert claims_of(out)["95 % interval"]["status"] == "refuted"


def test_a_sampled_wall_and_the_z_width_need_a_period(answer, tmp_path, capsys):
    assert main(["passivity", str(answer), "--wall", "1000", "0"]) == 2
    assert "need --period" in capsys.readouterr().err
    out = tmp_path / "claims.json"
    wall = ["--wall", "4000", "0", "--period", "1e-3", "--encoder-step", "1e-5"]
    assert main(["passivity", str(answer), *wall, "--json", str(out)]) == 0
    claims = claims_of(out)
    # 2 b/T = 3804 N/m at the low end of the damping's interval; known to 1e-6, rounded down
    assert claims["virtual wall, damping alone"]["status"] == "refuted"
    assert claims["virtual wall, encoder steps"]["status"] == "refuted"
    assert "stiffest passive wall 3803 N/m with damping 0 N*s/m" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "expected a folder, an answer"),
        (["missing.json"], "missing.json: cannot be read: No such file"),
        (["--check", "missing.json"], "no file of claims"),
        (["x.json", "--dahl", "0", "1"], "expected two numbers > 0"),
        (["x.json", "--period", "0"], "more than 0 s"),
        (["x.json", "--period", "1e-3", "--delay", "1.5e-3"], "1.5 periods"),
        (["diagram.toml"], "diagram.toml: cannot be read"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, capsys):
    assert main(["passivity", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def body_with(**values):
    body = td.Body("prismatic", {"inertia": td.Value(0.1)})
    for effect in dict.fromkeys(n.partition("__")[0] for n in values):
        parameters = {
            n.partition("__")[2]: v for n, v in values.items() if n.startswith(f"{effect}__")
        }
        body = body.with_effect(td.EFFECTS[effect], parameters)
    return body


def test_a_level_that_may_be_zero_covers_no_compensation():
    body = body_with(coulomb__level=0.5).with_values({"coulomb.level": td.Value(0.5, stderr=0.3)})
    with pytest.raises(ModelError, match="as low as"):
        identify_device(body)
    with pytest.raises(ModelError, match="no friction to compensate"):
        identify_device(body_with(viscous__damping=1.0))


@pytest.mark.slow
def test_in_a_computer_the_pair_is_held_against_what_readings_do_not_show(answer, tmp_path):
    out = tmp_path / "claims.json"
    law = ["--dahl", "0.4", "1.5e4", "--period", "0.001"]
    assert main(["passivity", str(answer), *law, "--json", str(out)]) == 0
    claims = claims_of(out)
    assert claims["estimate, continuous time"]["status"] == "proved"
    assert claims["small motion, sampled"]["status"] == "proved"
    assert claims["any motion, sampled"]["status"] == "refuted"


@pytest.mark.slow
def test_levels_of_an_answer_with_its_folder_are_bounded_over_the_reach(rod_answer, capsys):
    assert main(["passivity", str(td.example("rod")), "--answer", str(rod_answer)]) == 0
    assert "over speed 0 to " in capsys.readouterr().out

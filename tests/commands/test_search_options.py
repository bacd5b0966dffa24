"""What a user leaves out of a search, and what is shown while it runs."""

import json

import pytest

from teleopdesign.cli import main
from teleopdesign.diagnose.search_plan import QUICK


def effects_in(path):
    return {c["effect"] for c in json.loads(path.read_text())["candidates"]}


@pytest.mark.slow
def test_only_the_named_effects_are_candidates_and_the_answer_says_so(rod, few, tmp_path, capsys):
    answer = tmp_path / "answer.json"
    command = ["diagnose", str(rod), "--only", "stribeck", "bias", "--json", str(answer)]
    assert main(command) == 0
    assert effects_in(answer) == {"stribeck", "bias"}
    note = "only these effects were candidates: bias, stribeck"
    assert json.loads(answer.read_text())["left_out"] == [note]
    assert f"left out: {note}" in capsys.readouterr().out


@pytest.mark.slow
def test_quick_says_what_it_leaves_out_in_text_answer_and_report(rod, few, tmp_path, capsys):
    answer, page = tmp_path / "answer.json", tmp_path / "report.html"
    command = ["diagnose", str(rod), "--quick", "--json", str(answer), "--report", str(page)]
    assert main(command) == 0
    out = capsys.readouterr().out
    for words in QUICK.omissions():
        assert words in " ".join(out.split())
        assert words in json.loads(answer.read_text())["left_out"]
    assert "No more than 2 effects were added; pairs" in page.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--only", "stribek"], '--only: no effect "stribek"; did you mean "stribeck"?'),
        (["--exclude", "coulom"], '--exclude: no effect "coulom"; did you mean "coulomb"?'),
        (["--only", "bias", "--exclude", "bias"], "--exclude: leaves no effect to try"),
    ],
)
def test_a_wrong_name_is_one_line_with_the_nearest_name(arguments, expected, rod, refused):
    assert expected in refused("diagnose", rod, *arguments)


def test_a_folder_behind_only_is_asked_to_stand_before_it(rod, refused):
    line = refused("diagnose", rod, "--only", "bias", rod)
    assert f'"{rod}" is a file or folder: put it before --only' in line


# progress


# colours

"""The page of a saved answer."""

import json
import re
import shutil

import pytest

from teleopdesign.cli import main


def data_of(page):
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="teleopdesign-data">(.*?)</script>', text, re.DOTALL)[1])


@pytest.mark.slow
def test_the_page_of_an_answer_tells_what_the_answer_tells(answer, capsys):
    assert main(["report", str(answer)]) == 0
    page = answer.with_suffix(".html")
    output = capsys.readouterr().out
    assert f"written: {page}" in output and "nothing is searched or estimated again" in output
    shown, saved = data_of(page), json.loads(answer.read_text())
    assert shown["answer"]["candidates"] == saved["candidates"]
    assert shown["answer"]["verdict"] == saved["verdict"]
    assert [r["check_error"] for r in shown["report"]["ladder"]] == [
        row["check_error"] for row in saved["ladder"]
    ]
    rows = shown["report"]["candidates"]
    assert {r["effect"] for r in rows} == {c["effect"] for c in saved["candidates"]}
    steps = shown["report"]["candidate_steps"]
    assert all(len(r["steps"]) == len(steps) == len(saved["ladder"]) for r in rows)


@pytest.mark.slow
def test_the_page_of_a_folder_is_that_of_a_diagnosis_made_now(rod, few, tmp_path):
    page = tmp_path / "page.html"
    assert main(["report", str(rod), "--only", "stribeck", "--output", str(page)]) == 0
    assert [c["effect"] for c in data_of(page)["answer"]["candidates"]] == ["stribeck"]


def test_an_answer_whose_records_are_gone_is_one_line(answer, rod, refused):
    shutil.move(rod, rod.with_name("elsewhere"))
    line = refused("report", answer)
    assert 'its experiment was in "../rod", found no such folder' in line
    elsewhere = str(rod.with_name("elsewhere"))
    assert main(["describe", elsewhere, "--answer", str(answer), "--as-is"]) == 0


def test_an_answer_of_other_records_is_one_line(answer, rod, refused):
    toml = rod / "experiment.toml"
    text = toml.read_text()
    toml.write_text(text.replace('title = "', 'title = "Another '))
    assert "answer.json: is not an answer to rod but to another" in refused("report", answer)

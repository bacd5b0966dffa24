"""The table of real devices: a row each, also of those that are not here, and the page it fills."""

import json
from pathlib import Path
from runpy import run_path

import pytest
import recordings

from teleopdesign.base.errors import ExperimentError

ROOT = Path(__file__).parents[2]


def test_a_users_folder_comes_before_the_public_recordings(tmp_path):
    (tmp_path / "emps").mkdir()
    (tmp_path / "emps" / "experiment.toml").write_text("")
    names = recordings.names_in(tmp_path)
    assert names[0] == "emps" and names.count("emps") == 1 and "mtm_wrist" in names


def test_a_recording_that_is_not_here_is_a_row_with_the_reason(tmp_path, monkeypatch, capsys):
    def not_there(name, **_):
        raise ExperimentError(f"recordings: {name} cannot be downloaded")

    monkeypatch.setattr(recordings.td, "fetch", not_there)
    recordings.main(["emps", "--output", str(tmp_path)])
    rows = json.loads((tmp_path / "recordings.json").read_text())
    assert rows == {"emps": {"skipped": "recordings: emps cannot be downloaded"}}
    assert "not here" in capsys.readouterr().out


@pytest.mark.slow
def test_a_quick_run_diagnoses_one_recording_and_keeps_its_text_and_figure(tmp_path):
    recordings.main(
        ["rod", "--quick", "--folder", str(ROOT / "teleopdesign" / "examples"), "--output",
         str(tmp_path)]
    )  # fmt: skip
    row = json.loads((tmp_path / "recordings.json").read_text())["rod"]
    assert row["ladder"][0]["added"] is None and "verdict" in row["text"]
    assert (tmp_path / "rod.png").is_file() and row["seconds"]["processor"] > 0.0


def test_the_page_is_the_one_that_its_saved_rows_print():
    """By the tool that prints it: no figure on it is typed by hand."""
    made = run_path(str(ROOT / "docs" / "make_recordings.py"))
    rows = json.loads((made["COPIES"] / made["ROWS"]).read_text(encoding="utf-8"))
    text = made["PAGE"].read_text(encoding="utf-8")
    assert made["page"](text, rows) == text

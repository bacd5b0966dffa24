"""Many folders diagnosed: a table, an answer for each, and what is kept from run to run."""

import csv
import json
import shutil
from pathlib import Path

import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.cli import main
from teleopdesign.measurement.saving import content_digest, experiment_files
from teleopdesign.studies.folders import answer_files


@pytest.fixture
def runs(rod, tmp_path):
    """A sound folder, and one whose description is not."""
    broken = Path(shutil.copytree(rod, tmp_path / "broken"))
    toml = broken / "experiment.toml"
    toml.write_text(toml.read_text().replace('column = "x"', 'column = "pos"'))
    return [rod, broken]


def diagnose(folders, output, only="stribeck"):
    options = ["--output", str(output), "--workers", "1", "--only", only]
    return main(["diagnose", *map(str, folders), *options])


def table(output):
    with (output / "table.csv").open(newline="") as file:
        return {Path(row["folder"]).name: row for row in csv.DictReader(file)}


@pytest.mark.slow
def test_a_folder_that_fails_is_recorded_and_does_not_stop_the_rest(runs, few, tmp_path, capsys):
    output = tmp_path / "answers"
    assert diagnose(reversed(runs), output) == 2
    rows = table(output)
    assert rows["rod"]["verdict"] == json.loads((output / "rod.json").read_text())["verdict"]
    assert 0 < float(rows["rod"]["error_after"]) <= float(rows["rod"]["error_before"]) < 1
    assert 'no column "pos"' in rows["broken"]["failure"] and rows["broken"]["verdict"] == ""
    out = capsys.readouterr().out
    assert "1 of 2 folders diagnosed" in out and "failed: broken/fit.csv.gz" in out


def written(output):
    """When the answer of each folder was written."""
    return {path.stem: path.stat().st_mtime_ns for path in output.glob("*.json")}


@pytest.mark.slow
def test_the_next_call_does_what_is_missing_alone(runs, few, tmp_path):
    output = tmp_path / "answers"
    assert diagnose(runs, output) == 2
    before, first = table(output)["rod"], written(output)
    shutil.rmtree(runs[1])
    shutil.copytree(runs[0], runs[1])  # mended
    assert diagnose(runs, output) == 0
    assert written(output)["rod"] == first["rod"], "the sound folder was diagnosed once"
    assert table(output)["rod"] == before
    both = written(output)
    assert diagnose(runs, output) == 0 and written(output) == both
    (output / "rod.json").unlink()
    assert diagnose(runs, output) == 0
    again = written(output)
    assert again["broken"] == both["broken"] and again["rod"] > both["rod"]


@pytest.mark.slow
def test_a_folder_is_diagnosed_again_of_another_record_and_among_other_candidates(
    rod, few, tmp_path
):
    output = tmp_path / "answers"
    assert diagnose([rod], output) == 0
    before = table(output)["rod"]
    assert "stribeck" in before["missing"]
    toml = rod / "experiment.toml"
    toml.write_text(toml.read_text().replace("value = 60", "value = 30"))
    assert diagnose([rod], output) == 0
    assert table(output)["rod"]["error_before"] != before["error_before"]
    assert diagnose([rod], output, only="spring") == 0
    assert "stribeck" not in table(output)["rod"]["missing"]


def test_several_folders_need_a_place_for_their_answers(runs, refused, tmp_path):
    assert "2 folders: expected --output DIR" in refused("diagnose", *runs)
    line = refused("diagnose", *runs, "--output", tmp_path / "a", "--json", tmp_path / "b.json")
    assert "--json: is for one folder" in line
    assert "no such folder" in refused("diagnose", tmp_path / "no", "--output", tmp_path / "a")


def test_answers_are_named_after_their_folders_as_far_as_it_takes(tmp_path):
    folders = [tmp_path / "a" / "rod", tmp_path / "b" / "rod", tmp_path / "arm"]
    names = [path.name for path in answer_files(folders, tmp_path).values()]
    assert names == ["a-rod.json", "b-rod.json", "arm.json"]
    with pytest.raises(ExperimentError, match="found twice"):
        answer_files([folders[0], folders[0] / ".." / "rod"], tmp_path)


# what counts as the content of a folder


@pytest.mark.parametrize("name", ["/dev/zero", "../secret", "none.csv", "a\\u0000b"])
def test_no_file_outside_of_the_folder_is_read_for_the_digest(name, rod):
    (rod.parent / "secret").write_text("secret")
    toml = rod / "experiment.toml"
    toml.write_text(toml.read_text().replace("fit.csv.gz", name))
    files = experiment_files(rod)
    assert [path for path in files.values() if path is None] == [None]
    assert len(content_digest(rod)) == 64

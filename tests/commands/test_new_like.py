"""`teleopdesign new --like` reads a further log by columns, units and signs of an experiment."""

import gzip

import pytest

import teleopdesign as td
from teleopdesign.cli import main

EXAMPLE = td.example("rod")


@pytest.fixture
def second(tmp_path, monkeypatch):
    """A log of the same logger, beside a folder that turns the sign of its hand's force."""
    monkeypatch.chdir(tmp_path)
    rows = gzip.decompress((EXAMPLE / "check.csv.gz").read_bytes()).decode().splitlines()[:3001]
    (tmp_path / "second.csv").write_text("\n".join(rows))
    first = tmp_path / "first"
    first.mkdir()
    for path in EXAMPLE.glob("*.gz"):
        (first / path.name).write_bytes(path.read_bytes())
    text = (EXAMPLE / "experiment.toml").read_text()
    assert 'column = "f_h"' in text
    text = text.replace('column = "f_h"', 'column = "f_h", sign = -1')
    (first / "experiment.toml").write_text(text + '\n[guessed]\n"channels.time.column" = "first"\n')
    return tmp_path / "second.csv"


def test_columns_units_signs_and_model_are_those_of_the_experiment(second, capsys):
    assert main(["new", second.name, "--like", "first", "--output", "again"]) == 0
    assert "are those of first" in capsys.readouterr().out
    first, again = td.load_experiment("first"), td.load_experiment("again")
    assert again.channels == first.channels
    models = [td.Model.from_experiment(one) for one in (first, again)]
    assert models[0] == models[1]
    assert again.guesses == first.guesses
    assert [r.file for r in again.records] == ["second.csv"]
    before = td.load_experiment(EXAMPLE).check_records[0].signals["device.interaction_force"]
    now = again.records[0].signals["device.interaction_force"]
    assert now[:100] == pytest.approx(-before[:100])


def test_a_log_may_be_cut_or_be_one_of_two(second):
    spans = ["--fit-span", "0", "2", "--check-span", "2", "3"]
    assert main(["new", second.name, "--like", "first", "--output", "cut", *spans]) == 0
    assert [r.use for r in td.load_experiment("cut").records] == ["fit", "check"]
    logs = [second.name, str(EXAMPLE / "fit.csv.gz")]
    assert main(["new", *logs, "--like", "first", "--output", "two"]) == 0
    assert [r.file for r in td.load_experiment("two").check_records] == ["fit.csv.gz"]


def test_a_log_of_another_logger_is_refused_and_nothing_stays(second, capsys):
    text = second.read_text()
    second.write_text(text.replace("f_h", "hand", 1))
    assert main(["new", second.name, "--like", "first", "--output", "again"]) == 2
    assert 'no column "f_h"' in capsys.readouterr().err
    assert not (second.parent / "again").exists()
    assert main(["new", second.name, "--like", "first", "--unit", "x=mm"]) == 2
    assert "--like" in capsys.readouterr().err
    assert main(["new", second.name, "--like", "frist"]) == 2
    assert "first" in capsys.readouterr().err


def test_files_that_the_experiment_names_are_copied_from_its_folder_alone(second):
    """A diagram in a folder of its own is; what lies elsewhere, or a sentence, is no such file."""
    first, outside = second.parent / "first", second.parent / "private.toml"
    outside.write_text("")
    (first / "wired").mkdir()
    diagram = first / "wired" / "interface.toml"
    td.write_diagram(td.haptic_interface(td.Body("prismatic", {"inertia": 0.2})), diagram)
    (first / "experiment.toml").write_text(
        f"""
title = "{outside}"
[diagram]
file = "wired/interface.toml"
sample_period = {{ value = 1, unit = "ms" }}
[channels]
time = {{ column = "t", unit = "s" }}
"R_A" = {{ column = "u", unit = "N", resolution = 0.004 }}
"R_M" = {{ column = "f_h", unit = "N", noise = 0.01 }}
"L" = {{ column = "x", unit = "m", resolution = 1e-6 }}
[[records]]
file = "fit.csv.gz"
use = "fit"
"""
    )
    assert main(["new", second.name, "--like", "first", "--output", "again"]) == 0
    again = second.parent / "again"
    present = {p.relative_to(again).as_posix() for p in again.rglob("*") if p.is_file()}
    assert present == {"experiment.toml", "second.csv", "wired/interface.toml"}
    assert td.load_experiment(again).recorded == ("R_A", "R_M", "L")


def test_a_long_reason_of_a_guess_is_no_file(second):
    text = (second.parent / "first" / "experiment.toml").read_text()
    longer = text.replace('"first"', f'"{"the first column that rises " * 20}"')
    (second.parent / "first" / "experiment.toml").write_text(longer)
    assert main(["new", second.name, "--like", "first", "--output", "again"]) == 0

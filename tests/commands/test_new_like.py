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

"""Spans of a log that the page lets one choose, and two models beside each other."""

import shutil

import pytest

import teleopdesign as td
from teleopdesign.app import charts, logs, pages
from teleopdesign.app.workbench import Workbench
from teleopdesign.base.errors import ExperimentError
from teleopdesign.cli import main

FEW = ("coulomb", "viscous", "stribeck")


@pytest.fixture
def folder(tmp_path):
    shutil.copy(td.example("rod") / "fit.csv.gz", tmp_path / "swing.csv.gz")
    return tmp_path


def test_the_chosen_spans_are_those_of_the_records(folder):
    shown = logs.preview(folder, "swing.csv.gz")
    spans = logs.spans_of_sliders([6.0, 11.0], [1.0, 5.0], shown)
    name = logs.make_experiment(folder, shown, spans)
    records = td.load_experiment(folder / name).records
    assert [(r.use, round(r.time[0], 2), round(r.time[-1], 2)) for r in records] == [
        ("fit", 6.0, 11.0),
        ("check", 1.0, 5.0),
    ]
    shaded = shown.plot(spans).axes[0].get_legend_handles_labels()[1]
    assert shaded == ["fit", "check"]


@pytest.mark.parametrize(
    ("fit", "check", "expected"),
    [
        ([0, 8], [6, 11], "expected spans that do not overlap"),
        ([3, 3], [6, 11], "fit span: found 3 to 3 s"),
        ([0, 5], [50, 60], "check span: found 50 to 60 s"),
    ],
)
def test_spans_that_mean_nothing_are_refused(folder, fit, check, expected):
    with pytest.raises(ExperimentError, match=expected):
        logs.spans_of_sliders(fit, check, logs.preview(folder, "swing.csv.gz"))


@pytest.mark.slow
def test_a_command_takes_the_spans_too(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    spans = ["--fit-span", "5", "11", "--check-span", "0", "4"]
    assert main(["new", "swing.csv.gz", "--yes", *spans]) == 0
    records = td.load_experiment("swing_experiment").records
    assert [round(r.duration) for r in records] == [6, 4]
    assert main(["new", "swing.csv.gz", "--yes", "--fit-span", "5", "11"]) == 2
    assert "--fit-span: found alone, expected --check-span" in capsys.readouterr().err
    assert main(["new", "swing.csv.gz", "swing.csv.gz", "--yes", *spans, "--output", "b"]) == 2
    assert "found 2 logs, expected one that is cut" in capsys.readouterr().err


@pytest.fixture(scope="module")
def bench():
    known = {n: td.EFFECTS[n] for n in FEW}
    return Workbench.of(td.load_experiment(td.example("rod")), known=known)


def test_two_models_stand_beside_each_other(bench):
    better = bench.add("stribeck", "device")
    lines = pages.compare_rungs(better, 0, 1).splitlines()
    assert lines[0] == "| | your model, re-estimated | + stribeck at device |"
    level = next(line for line in lines if "extra_static_level" in line)
    assert level.split("|")[2].strip() == "-" and "N" in level.split("|")[3]
    errors = [line for line in lines if line.startswith("| check error")]
    before, after = (float(cell.split("%")[0]) for cell in errors[0].split("|")[2:4])
    assert after < before


def test_a_chart_shows_the_residual_of_both(bench):
    better = bench.add("stribeck", "device")
    data = pages.carried_residuals(better, 0, 1, "device")
    assert data[0]["carrier"].attrs["label"] == "velocity"
    chart = charts.comparison_chart(*data, "device", "check", ("yours", "other"))
    rows = chart.specification["datasets"][charts.ROWS]
    by_name = {n: [r["residual"] for r in rows if r["of"] == n] for n in ("yours", "other")}
    assert len(by_name["yours"]) == len(by_name["other"]) <= charts.MOST
    assert sum(x * x for x in by_name["other"]) < sum(x * x for x in by_name["yours"])


def test_the_workbench_tries_what_it_is_asked_to_beside_effects_that_are_described():
    workbench = Workbench.of(td.load_experiment(td.example("rod")), among=["bias", "coulomb"])
    assert [r.candidate.key for r in workbench.candidates] == [("bias", "device")]


def test_a_page_is_not_served_for_an_unknown_effect(tmp_path, capsys):
    pytest.importorskip("marimo", reason="needs the extra app")
    assert main(["app", str(tmp_path), "--no-browser", "--only", "stribek"]) == 2
    assert 'did you mean "stribeck"' in capsys.readouterr().err

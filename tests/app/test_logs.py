"""From a log to an experiment, as the page does it."""

import re
import shutil
from dataclasses import fields
from html import unescape

import numpy as np
import pytest

from teleopdesign import example, load_experiment
from teleopdesign.app import logs
from teleopdesign.base.errors import ExperimentError


@pytest.fixture
def folder(tmp_path):
    shutil.copy(example("rod") / "fit.csv.gz", tmp_path / "swing.csv.gz")
    return tmp_path


def test_the_columns_are_recognised_and_guesses_are_reported(folder):
    shown = logs.preview(folder, "swing.csv.gz")
    assert shown.columns == ("t", "u", "x", "f_h")
    table = unescape(shown.table())
    assert "| position | x | m | m: the name" in table
    assert "| actuator_force | u | N |" in table
    assert "| interaction_force | f_h | N |" in table
    assert len(shown.plot().axes) == 3  # position, actuator force, force of the hand


def test_what_is_chosen_counts_and_the_experiment_opens(folder):
    answers = {"axis": None, "hand force": "f_h", "torque constant": "", "gear ratio": None}
    shown = logs.preview(folder, "swing.csv.gz", answers)
    name = logs.make_experiment(folder, shown)
    experiment = load_experiment(folder / name)
    assert experiment.channels["device.interaction_force"].column == "f_h"
    assert [r.use for r in experiment.records] == ["fit", "check"]
    with pytest.raises(ExperimentError, match="swing_experiment: is there already"):
        logs.make_experiment(folder, shown)


def test_what_a_table_of_markdown_would_take_for_marks_is_shown_as_it_is(tmp_path):
    """Units have stars, names have bars, dollars and underscores."""
    mo = pytest.importorskip("marimo", reason="needs the extra app")
    t = np.arange(2000) / 500
    q, u = np.sin(2 * t), np.sign(np.cos(2 * t))
    head = "t [s],pos_1 (rad),cur|rent_1 (A),a*b*c,$x$,<b>_y_</b>"
    rows = np.column_stack([t, q, u, np.cos(3 * t), np.cos(4 * t), np.cos(5 * t)])
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header=head, comments="")
    shown = logs.preview(tmp_path, "log.csv")
    html = mo.md(shown.table()).text
    text = unescape(re.sub("<[^>]*>", " ", html))
    for name in head.split(",")[1:]:
        assert name in text, name
    assert "1 N*m/A is a placeholder for" in text
    assert "<em>" not in html and "arithmatex" not in html


@pytest.fixture
def bare(tmp_path):
    """A log whose names say no unit: s, degrees, mA, Nm of a revolute axis."""
    t = np.arange(3000) / 500
    q = 25.0 * np.sin(2 * t)
    i = 800 * np.sign(np.cos(2 * t)) + 30 * q
    rows = np.column_stack([t, q, i, np.cos(3 * t)])
    head = "tick,joint,drive,cell"
    np.savetxt(tmp_path / "bare.csv", rows, delimiter=",", header=head, comments="", fmt="%.9g")
    return tmp_path


STATED = {
    "time": "tick",
    "time unit": "s",
    "position": "joint",
    "position unit": "deg",
    "actuator force": "drive",
    "actuator force unit": "mA",
    "hand force": "cell",
    "hand force unit": "Nm",
    "torque constant": "0.05 N*m/A",
}


def test_a_column_without_a_unit_gets_one_by_hand(bare):
    guess = logs.preview(bare, "bare.csv", {"position": "joint", "actuator force": "drive"})
    assert "*position*" in guess.guessed_units() and "*actuator force*" in guess.guessed_units()
    shown = logs.preview(bare, "bare.csv", STATED)
    assert shown.guessed_units() == ""
    experiment = load_experiment(bare / logs.make_experiment(bare, shown))
    units = {name.partition(".")[2]: c.unit for name, c in experiment.channels.items()}
    assert units.items() >= {
        ("position", "deg"),
        ("actuator_force", "mA"),
        ("interaction_force", "Nm"),
    }
    (fit,) = experiment.fit_records
    assert np.ptp(fit.signals["device.position"]) == pytest.approx(np.radians(50), rel=0.01)


def test_a_unit_counts_for_the_recognised_column(bare):
    """No column is chosen: the unit is that of the column that the table shows."""
    column = logs.preview(bare, "bare.csv").survey.channels["position"]["column"]
    position = logs.preview(bare, "bare.csv", {"position unit": "deg"}).survey.channels["position"]
    assert (position["column"], position["unit"]) == (column, "deg")
    with pytest.raises(ExperimentError, match="hand force unit: choose the column of the hand"):
        logs.preview(bare, "bare.csv", {**STATED, "hand force": None, "position unit": "rad"})


@pytest.mark.parametrize("name", logs.QUANTITIES)
@pytest.mark.parametrize(
    ("unit", "says"), [("furlong", "expected a unit such as"), ("kg", "expected one of a")]
)
def test_a_wrong_unit_is_one_line_that_names_column_and_unit(bare, name, unit, says):
    with pytest.raises(ExperimentError) as refused:
        logs.preview(bare, "bare.csv", {**STATED, f"{name} unit": unit})
    line = str(refused.value)
    assert "\n" not in line and STATED[name] in line and unit in line and says in line


def test_every_choice_of_a_survey_has_a_field_on_the_page(bare):
    """What the command asks for when it is not sure, the page can be told as well."""
    answers = {
        **STATED,
        "axis": "revolute",
        "lever arm": "70 mm",
        "gear ratio": "2",
        "counts per turn": "4096",
        "sample rate (Hz)": "500,0",
    }
    pytest.importorskip("marimo", reason="needs the extra app")
    from teleopdesign.app import views

    assert set(answers) == set(views.column_form(("a",)).elements)
    choices = logs.choices_of(answers)
    unsaid = [f.name for f in fields(choices) if not getattr(choices, f.name) and f.name != "units"]
    assert unsaid == []
    assert set(logs.units_of(answers)) == set(logs.QUANTITIES.values())


def test_a_log_without_recognised_columns_still_shows_its_columns(tmp_path):
    t = np.arange(5000) / 100
    rng = np.random.default_rng(3)
    rows = np.column_stack([t, np.sin(t), rng.normal(size=(5000, 2))])
    np.savetxt(tmp_path / "x.csv", rows, delimiter=",", header="t,a,b,c", comments="")
    with pytest.raises(ExperimentError, match="found no force"):
        logs.preview(tmp_path, "x.csv")
    assert logs.columns_of(tmp_path, "x.csv") == ("t", "a", "b", "c")
    chosen = logs.preview(tmp_path, "x.csv", {"actuator force": "b"})
    assert chosen.survey.channels["actuator_force"]["column"] == "b"


@pytest.mark.parametrize("name", ["torque constant", *logs.NUMBERS])
@pytest.mark.parametrize("text", ["big", "nan", "0.05 furlong"])
def test_a_constant_that_is_no_number_is_named(name, text):
    with pytest.raises(ExperimentError, match=re.escape(f"{name}: found {text!r}, expected a num")):
        logs.choices_of({name: text})


@pytest.mark.parametrize("name", logs.NUMBERS)
def test_a_number_that_no_device_has_is_refused(folder, name):
    with pytest.raises(ExperimentError, match=f"{logs.NUMBERS[name]}: found 0, expected"):
        logs.preview(folder, "swing.csv.gz", {name: "0"})

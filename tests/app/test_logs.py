"""From a log to an experiment, as the page does it."""

import re
import shutil
from html import unescape

import numpy as np
import pytest

from teleopdesign import example, load_experiment
from teleopdesign.app import logs
from teleopdesign.errors import ExperimentError


@pytest.fixture
def folder(tmp_path):
    shutil.copy(example("rod") / "fit.csv.gz", tmp_path / "swing.csv.gz")
    return tmp_path


def test_the_columns_are_found_and_what_is_guessed_is_said(folder):
    shown = logs.preview(folder, "swing.csv.gz")
    assert shown.columns == ("t", "u", "x", "f_h")
    table = unescape(shown.table())
    assert "| position | x | m | m, from its range" in table
    assert "| actuator_force | u | N |" in table
    assert "| interaction_force | f_h | N |" in table
    assert len(shown.plot().axes) == 3  # position, actuator force, force of the hand


def test_what_is_chosen_counts_and_the_experiment_opens(folder):
    answers = {"axis": None, "hand force": "f_h", "torque constant": "", "gear ratio": None}
    shown = logs.preview(folder, "swing.csv.gz", logs.choices_of(answers))
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
    assert "1 N*m/A stands for" in text
    assert "<em>" not in html and "arithmatex" not in html


def test_a_constant_that_is_no_number_is_named(folder):
    with pytest.raises(ExperimentError, match="torque constant: found 'big', expected a number"):
        logs.choices_of({"torque constant": "big"})


def test_a_log_outside_of_the_folder_is_not_opened(folder):
    with pytest.raises(ExperimentError, match="lies outside"):
        logs.preview(folder, "../other.csv")

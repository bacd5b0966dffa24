"""From a log to an experiment, as the page does it."""

import shutil

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
    table = shown.table()
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


def test_a_constant_that_is_no_number_is_named(folder):
    with pytest.raises(ExperimentError, match="torque constant: found 'big', expected a number"):
        logs.choices_of({"torque constant": "big"})


def test_a_log_outside_of_the_folder_is_not_opened(folder):
    with pytest.raises(ExperimentError, match="lies outside"):
        logs.preview(folder, "../other.csv")

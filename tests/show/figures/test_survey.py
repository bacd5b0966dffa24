"""The picture of a new log: each channel in its unit, and the columns that are not used."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign import load_experiment
from teleopdesign.cli import main
from teleopdesign.measurement.survey import Choices, Survey, survey_log
from teleopdesign.measurement.tables import open_log
from teleopdesign.show.figures.log import draw_survey


def test_each_channel_has_a_panel_and_each_other_column_a_line(no_picture, tmp_path):
    t = np.arange(2000) / 500
    rows = np.column_stack([t, 30 * np.sin(2 * t), np.sign(np.cos(2 * t)), np.cos(9 * t)])
    log, made = tmp_path / "log.csv", tmp_path / "made"
    head = "t_s,angle_deg,torque_Nm,humidity"
    np.savetxt(log, rows, delimiter=",", header=head, comments="", fmt="%.6g")
    assert main(["new", str(log), "--yes", "--output", str(made)]) == 0
    survey = survey_log(open_log(log, log.name), log.name, Choices())
    figure = no_picture["draw_survey"](survey, load_experiment(made))
    position, force, over_velocity = figure.axes
    assert position.get_ylabel() == "position\n(rad)"
    assert position.get_title(loc="left") == 'column "angle_deg" in deg'
    assert force.get_ylabel() == "actuator force\n(N*m)"
    assert max(position.lines[0].get_ydata()) < 0.6, "rad, not deg"
    assert over_velocity.get_xlabel() == "velocity (rad/s)"
    assert any('not used: "humidity": ' in text.get_text() for text in figure.texts)


@pytest.mark.parametrize("size", [1.2e-4, 0.037, 2e5])
def test_the_labels_beside_numbers_of_any_length_are_in_the_picture(size):
    t = np.arange(2000) / 500
    log = {"t_s": t, "x_m": size * np.sin(3 * t), "f_N": size * np.cos(2 * t)}
    names = {"position": "x_m", "actuator_force": "f_N"}
    units = {"x_m": "m", "f_N": "N"}
    experiment = td.experiment(log, axis="prismatic", inertia=0.1, units=units, **names)
    figure = draw_survey(Survey("prismatic", {}, 4.0), experiment)
    figure.draw_without_rendering()
    assert min(a.yaxis.label.get_window_extent().x0 for a in figure.axes) > 0.0

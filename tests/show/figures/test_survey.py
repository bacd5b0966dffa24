"""The picture of a new log: each channel in its unit, and the columns that are not used."""

import numpy as np

from teleopdesign import load_experiment
from teleopdesign.cli import main
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log


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

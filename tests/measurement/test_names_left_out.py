"""Names that a header leaves out, and one name for several columns."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log

ROWS = 1500
T = 0.01 * np.arange(ROWS)
Q = 40.0 + 30.0 * np.sin(2 * np.pi * 0.3 * T) * np.cos(0.2 * T)
RATE = np.gradient(Q, T)
U = 0.05 * np.gradient(RATE, T) + 2.0 * np.sign(RATE) + 0.1 * RATE


def write(folder, header, columns):
    table = np.column_stack(columns)
    path = folder / "log.csv"
    np.savetxt(path, table, delimiter=";", header=header, comments="", fmt="%.6f")
    return open_log(path, path.name)


def test_a_column_of_stamps_without_a_name_gets_the_name_of_its_place(tmp_path):
    """An experiment with an empty name of a column was written, which cannot be read."""
    log = write(tmp_path, ";Position;Torque\nms;deg;Nm", (1e3 * T, Q, U))
    assert log.names == ("column 1", "Position", "Torque")
    survey = survey_log(log, "log.csv", Choices())
    assert survey.channels["time"] == {"column": "column 1", "unit": "ms"}
    assert survey.duration == pytest.approx(T[-1])


def test_one_name_beside_the_time_stands_for_an_array(tmp_path):
    """The table was refused: "row 1: found 4 cells, expected 2 as in the header"."""
    log = write(tmp_path, '"Time";"data"', (T, U, RATE, Q))
    assert log.names == ("Time", "data(:,1)", "data(:,2)", "data(:,3)")
    assert any("one name for an array" in note for note in log.notes)
    survey = survey_log(log, "log.csv", Choices())
    assert survey.channels["position"]["column"] == "data(:,3)"
    assert survey.channels["actuator_force"]["column"] == "data(:,1)"


def test_a_header_that_is_one_name_short_is_refused(tmp_path):
    """The name of the first column may be left out as well as that of the last one."""
    with pytest.raises(ExperimentError, match="found 3 cells, expected 2"):
        log = write(tmp_path, "Time;data", (T, U, Q))
        log.read(dict.fromkeys(log.names, ""))

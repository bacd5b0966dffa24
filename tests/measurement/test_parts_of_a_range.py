"""Per cent of a range, and speeds without a position."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.units import measures, si_factor
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log

ROWS = 1500
T = 0.01 * np.arange(ROWS)
Q = 40.0 + 30.0 * np.sin(2 * np.pi * 0.3 * T) * np.cos(0.2 * T)
RATE = np.gradient(Q, T)
U = 0.05 * np.gradient(RATE, T) + 2.0 * np.sign(RATE) + 0.1 * RATE


def look(columns, units=None, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted}, units or {})
    return survey_log(log, "log", Choices(**choices))


@pytest.mark.parametrize("axis", ["prismatic", "revolute"])
def test_per_cent_is_no_angle_although_both_have_no_dimension(axis):
    assert not measures("%", "position", axis)
    assert measures("%", "dimensionless") and measures("rad", "position", "revolute")
    with pytest.raises(ExperimentError, match='found "%", expected a'):
        si_factor("%", quantity="position", axis=axis)


def test_a_speed_beside_a_torque_in_per_cent_is_a_log_without_a_position():
    """The torque was read as an angle in parts of a radian, and the speed as its set point."""
    for columns, units in (
        ({"Time [s]": T, "Speed [rpm]": RATE, "Torque [%]": U}, None),
        ({"ms": 1e3 * T, "Speed": RATE, "Torque": U}, {"Speed": "rpm", "Torque": "%", "ms": "ms"}),
    ):
        with pytest.raises(ExperimentError, match="found no position.* the integral of 'Speed"):
            look(columns, units)


def test_a_valve_in_per_cent_of_its_stroke_has_a_guessed_unit():
    """It was read in parts of a radian, which no guess told."""
    columns = {"t": T, "Position [%]": Q, "Set point [%]": np.roll(Q, -30), "Current [A]": U}
    survey = look(columns)
    assert survey.channels["position"]["column"] == "Position [%]"
    assert survey.channels["position"]["unit"] != "%"
    assert "is no unit of a" in survey.guesses["channels.position.unit"]
    assert survey.channels["actuator_force"]["column"] == "Current [A]"


@pytest.mark.parametrize("wanted", ["rpm_sp", "rpm_ref", "speed_cmd"])
@pytest.mark.parametrize("command", ["out", "y"])
def test_the_output_of_a_speed_loop_is_no_position(command, wanted):
    """The output of the controller was the position, or the set point of the speed was."""
    columns = {"t": T, "rpm": RATE, command: U, wanted: np.where(T < 7, 60.0, 140.0)}
    with pytest.raises(ExperimentError) as problem:
        look(columns)
    assert (
        f"if it is one: --position {command!r}; else add a column with the integral of 'rpm'"
        in (str(problem.value))
    )
    with_position = look({**columns, "angle_deg": 6.0 * np.cumsum(RATE) * 0.01})
    assert with_position.channels["position"]["column"] == "angle_deg"
    assert with_position.channels["actuator_force"]["column"] == command


def test_a_column_whose_derivative_is_logged_needs_no_name_of_a_position():
    survey = look({"t": T, "y1": Q, "speed": RATE, "torque": U})
    assert survey.channels["position"]["column"] == "y1"


def test_an_input_in_volts_is_named_in_the_message_of_a_log_without_a_position():
    with pytest.raises(ExperimentError, match="if 'Input 1' is the position: --position 'Input 1'"):
        look({"time": T, "Force": U, "Input 1": Q}, {"Force": "V", "Input 1": "V"})

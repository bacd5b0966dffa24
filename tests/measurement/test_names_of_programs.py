"""Names and wraps of columns as drives, robots and simulators log them."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.column_names import is_wanted, likeness, unit_in_name
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log

T = 0.004 * np.arange(3000)
Q = 40 * np.sin(2 * np.pi * 0.7 * T) + 25 * np.sin(2 * np.pi * 1.9 * T)
V = np.gradient(Q, T)
U = 1e-4 * np.gradient(V, T) + 0.3 * np.sign(V)


def look(columns, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices(**choices))


def test_a_column_called_set_is_a_set_point():
    columns = {"time": T, "Motor angle": Q, "Set angle": np.roll(Q, -3), "Torque": U}
    assert look(columns).channels["position"]["column"] == "Motor angle"
    assert is_wanted("SetPos") and is_wanted("commanded_position") and not is_wanted("offset")


def test_a_position_that_wraps_at_a_turn_is_an_angle_beside_a_length():
    """A drive of a wheel logs the way of the wheel in metres beside its encoder in degrees."""
    columns = {
        "ms_today": 1e3 * T, "current_motor": U, "encoder_position": np.round(Q, 2) % 360,
        "speed_meters_per_sec": np.round(V * 1e-3, 3), "tacho_meters": np.round(Q * 1e-3, 3),
    }  # fmt: skip
    proposal = look(columns)
    assert proposal.axis == "revolute"
    assert proposal.channels["position"]["column"] == "encoder_position"
    assert proposal.channels["position"]["unit"] == "deg"
    assert proposal.channels["position"]["unwrap"] is True
    assert "wraps at a turn in deg" in proposal.guesses["model.device.axis"]


def test_a_position_that_wraps_at_two_pi_is_in_rad():
    turned = np.deg2rad(8 * Q)
    columns = {"t": T, "x_pos": turned % (2 * np.pi), "tacho_meters": Q, "force": U}
    proposal = look(columns, position="x_pos")
    assert (proposal.axis, proposal.channels["position"]["unit"]) == ("revolute", "rad")


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("speed_meters_per_sec", "m/s"),
        ("rate_degrees_per_second", "deg/s"),
        ("wheel_revs_per_sec", "rev/s"),
        ("words_per_sec", "s"),
        ("v_mm_s", "mm/s"),
        ("tau_N_m", "N*m"),
        ("IL.FB (Arms)", "A"),
        ("robot_arms", None),
        ("Lageistwert [Grd]", "deg"),
    ],
)
def test_units_of_two_words_in_names(name, unit):
    assert unit_in_name(name) == unit


def test_names_of_a_simulator_are_position_velocity_and_force():
    assert likeness("qpos_0", "position") > 0.7 and likeness("qvel_0", "velocity") > 0.7
    assert likeness("qfrc_actuator_0", "actuator_force") > 0.7
    columns = {"time": T, "qpos_0": Q, "qvel_0": V, "ctrl_0": U / 2.5, "qfrc_actuator_0": U}
    proposal = look(columns).channels
    assert proposal["position"]["column"] == "qpos_0"
    assert proposal["actuator_force"]["column"] == "qfrc_actuator_0"


def test_the_q_axis_of_a_motor_is_no_position():
    assert likeness("q_axis_current", "position") == 0.0 == likeness("d_axis_voltage", "position")
    columns = {"t": T, "rotor": Q, "q_axis_current": U, "d_axis_current": 0.01 * np.sin(31 * T)}
    proposal = look(columns).channels
    assert proposal["position"]["column"] == "rotor"
    assert proposal["actuator_force"]["column"] == "q_axis_current"


def test_a_scope_with_channels_in_volts_says_how_to_choose_the_position():
    columns = {"TIME": T, "CH1 (V)": 0.02 * Q, "CH2 (V)": U}
    with pytest.raises(ExperimentError, match=r"--position 'CH1 \(V\)', then `scale`.*per V"):
        look(columns)
    guesses = look(columns, position="CH1 (V)", actuator_force="CH2 (V)").guesses
    assert "`scale` = m per V is missing" in guesses["channels.position.unit"]


def test_whole_numbers_of_a_long_range_are_counts_of_a_turning_axis():
    columns = {"Sample #": np.arange(3000.0), "Ax 0 Act Pos": np.round(60 * Q), "Ax 0 DAC": 9e3 * U}
    proposal = look(columns)
    assert (proposal.axis, proposal.channels["position"]["unit"]) == ("revolute", "counts")
    assert "whole numbers" in proposal.guesses["model.device.axis"]
    assert proposal.guesses["channels.time.unit"].endswith("--sample-rate HZ")

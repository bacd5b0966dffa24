"""Logs of drives, dates in any kind of file, and constants that stand beside the columns."""

import json

import numpy as np
import pandas as pd
import pytest
from scipy.io import savemat

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.numbers_in_cells import holds_dates
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log

ROWS = 1500
T = 0.005 * np.arange(ROWS)
Q = np.sin(2 * np.pi * 0.7 * T) + 0.2 * np.sin(2 * np.pi * 2.1 * T)
RATE = np.gradient(Q, T)
U = 0.02 * np.gradient(RATE, T) + 0.3 * np.tanh(RATE / 0.05)


def look(columns, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices(**choices))


@pytest.mark.parametrize("unit", ["qc", "Inkr", "Ink", "incr", "pulses", "Impulse", "cnt"])
def test_a_drive_reports_counts_and_turns_per_minute(unit):
    """Quadrature counts were read as millimetres, beside a velocity in rpm."""
    noise = 0.01 * np.random.default_rng(1).standard_normal(ROWS)
    columns = {
        "Time [ms]": 1e3 * T,
        f"Position actual value [{unit}]": np.round(30 * Q / (2 * np.pi) * 2000),
        "Velocity actual value [rpm]": 30 * RATE * 60 / (2 * np.pi),
        "Current demand value [mA]": 1e3 * U,
        "Current actual value [mA]": 1e3 * (U + noise),
    }
    survey = look(columns)
    position = survey.channels["position"]
    assert (survey.axis, position["unit"]) == ("revolute", "counts")
    assert position["counts_per_turn"] == 2000
    assert survey.channels["velocity"]["unit"] == "rpm"
    assert survey.channels["actuator_force"]["column"] == "Current demand value [mA]"


@pytest.mark.parametrize(
    ("rate", "axis"),
    [("v (rpm)", "revolute"), ("v (mm/s)", "prismatic"), ("v (deg/s)", "revolute")],
)
def test_the_unit_of_a_velocity_tells_the_axis(rate, axis):
    survey = look({"t": T, "pos": Q, rate: RATE, "u": U})
    assert survey.axis == axis and "velocity is in" in survey.guesses["model.device.axis"]


def clock_texts():
    return [f"10:{11 + int(t + 55) // 60}:{(t + 55) % 60:06.3f}" for t in T.tolist()]


@pytest.mark.parametrize("name", ["Time of day", "Timestamp [ms]", "t_us"])
@pytest.mark.parametrize("ending", ["csv", "xlsx", "parquet", "jsonl", "npz"])
def test_a_time_of_day_is_in_seconds_whatever_its_name_and_file(tmp_path, name, ending):
    """ "Time of day" ends in a unit: 12 s of a workbook lasted twelve days."""
    columns = {name: clock_texts(), "angle (deg)": np.rad2deg(Q), "torque (Nm)": U}
    file = tmp_path / f"log.{ending}"
    table = pd.DataFrame(columns)
    if ending == "npz":
        np.savez(file, **{n: np.asarray(x) for n, x in columns.items()})
    elif ending == "jsonl":
        file.write_text("\n".join(json.dumps(row) for row in table.to_dict("records")))
    else:
        kept = {} if ending == "parquet" else {"index": False}
        getattr(table, {"csv": "to_csv", "xlsx": "to_excel", "parquet": "to_parquet"}[ending])(
            file, **kept
        )
    survey = survey_log(open_log(file, file.name), file.name, Choices())
    assert survey.channels["time"] == {"column": name, "unit": "s"}
    assert survey.duration == pytest.approx(T[-1], abs=1e-3)


@pytest.mark.parametrize("name", ["Time of day", "Timestamp [ms]"])
def test_a_time_of_day_among_arrays_is_in_seconds(name):
    table = pd.DataFrame({name: clock_texts(), "q": Q, "u": U})
    choices = dict(axis="revolute", time=name, position="q", actuator_force="u")
    experiment = td.experiment(table, **choices, units={"q": "rad", "u": "Nm"})
    assert experiment.records[0].sample_time == pytest.approx(0.005, rel=1e-3)


@pytest.mark.parametrize("cells", [["1.5", "2.5"], [1.0, 2.0], ["a", "b"], [], [None, None]])
def test_numbers_and_words_are_no_dates(cells):
    assert not holds_dates(np.array(cells, dtype=object))


def test_a_single_value_of_a_matlab_file_is_listed_with_its_number(tmp_path):
    """It was said to hold no numbers."""
    file = tmp_path / "log.mat"
    values = {"gear_ratio": 30.0, "cpr": 2000.0, "note": "joint 3"}
    savemat(file, {"t": T, "enc": np.round(30 * Q / (2 * np.pi) * 2000), "i_A": U, **values})
    survey = survey_log(open_log(file, file.name), file.name, Choices())
    assert survey.unused["gear_ratio"] == "one value: 30"
    assert survey.channels["position"]["counts_per_turn"] == 2000
    assert any("--gear-ratio 30" in note for note in survey.notes)


def test_a_log_of_velocities_alone_says_what_to_add():
    with pytest.raises(ExperimentError, match="add a column with the integral of 'omega_rad_s'"):
        look({"t": T, "omega_rad_s": RATE, "tau_Nm": U})


def test_a_measured_velocity_is_the_derivative_and_neither_its_reference_nor_a_tilt():
    """A log of a robot on wheels: the reference is smoother than the measured velocity."""
    noise = 0.1 * np.random.default_rng(5).standard_normal(len(T))
    columns = {
        "t": T, "x [m]": Q, "v_ref [m/s]": RATE, "v [m/s]": RATE + noise,
        "tilt [rad]": 0.2 * RATE, "u [V]": U,
    }  # fmt: skip
    survey = look(columns)
    assert survey.notes[0] == "'v [m/s]' is the derivative of 'x [m]'"
    assert survey.channels["velocity"]["column"] == "v [m/s]"
    assert survey.unused["tilt [rad]"] == "a position beside 'x [m]'"


def test_the_integral_of_a_desired_velocity_is_no_position():
    columns = {"t": T, "targetSpeed": RATE, "leftSpeed": RATE, "leftCommand": U}
    with pytest.raises(ExperimentError, match="add a column with the integral of 'leftSpeed'"):
        look(columns)


def test_a_voltage_is_no_position_beside_a_speed():
    """ "voltage" and "rpm" gave a position in volts, and no word of the speed."""
    columns = {"time": T, "voltage": 6.0 * np.sin(T), "rpm": 30.0 * np.cos(T)}
    with pytest.raises(ExperimentError, match="found no position.*integral of 'rpm'"):
        look(columns)


def test_a_voltage_drives_a_motor_in_volts():
    survey = look({"time": T, "angle_deg": np.sin(T), "voltage": np.cos(T)})
    force = survey.channels["actuator_force"]
    assert (force["column"], force["unit"]) == ("voltage", "V")
    assert force["torque_constant"]["unit"] == "N*m/V"


def test_a_brushless_motor_is_driven_by_its_current_and_turns():
    """Of "Iq" and "Uq", which drives against the speed, the voltage was read, and mm and N."""
    columns = {"Time": T, "Position": 20.0 * np.sin(6.0 * T), "Velocity": 120.0 * np.cos(6.0 * T)}
    current = -0.4 * np.sin(6.0 * T) + 0.05 * np.sign(np.cos(6.0 * T))
    survey = look({**columns, "Iq": current, "Uq": 2.5 * np.cos(6.0 * T) + 0.5 * current})
    assert survey.axis == "revolute"
    assert survey.channels["actuator_force"]["column"] == "Iq"
    assert survey.channels["actuator_force"]["unit"] == "A"
    assert "a second force" in survey.unused["Uq"]


def test_a_position_named_like_a_force_is_proposed():
    with pytest.raises(ExperimentError, match="if 'sensor' is the position: --position 'sensor'"):
        look({"time": T, "sensor": np.sin(T), "action": 0.0 * T})


def test_a_guessed_clock_is_stated_where_the_log_is_too_short():
    """A column that numbers the rows was taken for ms, and the log for one of 0.249 s."""
    columns = {"n": np.arange(250.0), "x": np.sin(np.arange(250.0)), "u": np.cos(np.arange(250.0))}
    with pytest.raises(ExperimentError, match="'n' is read as the time: .*--sample-rate HZ"):
        look(columns)
    with pytest.raises(ExperimentError, match="at least 64$"):
        look({name: values[:9] for name, values in columns.items()})

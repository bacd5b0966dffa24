"""Units of inches, pounds and ounces, and units that fit no quantity: never read as SI unsaid."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.units import is_unit, to_si
from teleopdesign.measurement.description import motor_constant
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log

T = np.arange(1500) / 500.0
Q = 0.5 * np.sin(2 * np.pi * 0.7 * T) + 0.1 * np.sin(2 * np.pi * 2.3 * T)
U = 0.02 * np.gradient(np.gradient(Q, T), T) + 0.1 * np.sign(np.gradient(Q, T))
INCH, POUND = 0.0254, 4.4482216152605


def look(columns, **choices):
    return survey_log(
        Log(tuple(columns), lambda names: {n: columns[n] for n in names}), "log", Choices(**choices)
    )


@pytest.mark.parametrize(
    ("unit", "quantity", "axis", "si"),
    [
        ("in", "position", "prismatic", INCH),
        ("in/s", "velocity", "prismatic", INCH),
        ("lbf", "force", "prismatic", POUND),
        ("ozf*in", "force", "revolute", POUND * INCH / 16),
        ("lbf*ft", "force", "revolute", POUND * 12 * INCH),
        ("kgf-cm", "force", "revolute", 0.0980665),
        ("N.m", "force", "revolute", 1.0),
        ("mN-m", "force", "revolute", 1e-3),
        ("N⋅m", "force", "revolute", 1.0),
        ("ozf*in*s^2/rad", "inertia", "revolute", POUND * INCH / 16),
    ],
)
def test_inches_pounds_and_points_are_converted(unit, quantity, axis, si):
    assert to_si(1.0, unit, quantity=quantity, axis=axis) == pytest.approx(si, rel=1e-12)


def test_arrays_with_a_unit_that_does_not_fit_are_refused():
    """They were silently read in SI: inches as metres."""
    data = {"t": T, "q": Q, "u": U, "Hand [N]": U}
    words = {"axis": "revolute", "position": "q", "actuator_force": "u", "inertia": 0.02}
    with pytest.raises(
        ExperimentError, match=r"'N', of 'Hand \[N\]', is no unit of a torque: .*lever_arm"
    ):
        td.experiment(data, interaction_force="Hand [N]", **words)
    lever = {"column": "Hand [N]", "unit": "N*m", "scale": 0.07}
    scaled = td.experiment(data, interaction_force=lever, **words)
    assert scaled.records[0].signals["device.interaction_force"] == pytest.approx(0.07 * U)


@pytest.mark.parametrize(
    ("text", "axis"),
    [
        ("23.4 mNm/A", "revolute"),
        ("0.0234 N m/A", "revolute"),
        ("3.31 oz-in/A", "revolute"),
        ("12 N/A", "prismatic"),
        ("2.7 lbf/A", "prismatic"),
    ],
)
def test_a_torque_constant_turns_the_axis_in_whatever_unit(text, axis):
    """Only "N*m/A" did: a data sheet's "mNm/A" made the axis prismatic, and was then refused."""
    columns = {"t": T, "x": Q, "i_A": U}
    survey = look(columns, torque_constant=motor_constant(text, where="--torque-constant"))
    assert survey.axis == axis


@pytest.mark.parametrize("text", ["12", "3 A", "0.02 kg/A", "0.02 Nm/s", "Nm/A", "1e999 Nm/A"])
def test_what_is_no_torque_constant_is_refused(text):
    with pytest.raises(ExperimentError, match="such as"):
        motor_constant(text, where="--torque-constant")


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("125 us", 125e-6), ("1/8000 s", 125e-6), ("1.25e-4 s", 125e-6), ("0.5 ms", 5e-4)],
)
def test_ticks_of_a_clock_are_several_times_a_unit_of_time(text, seconds):
    ticks = np.round(T / seconds) + 7000.0
    survey = look({"ticks": ticks, "angle_rad": Q, "u [Nm]": U}, units={"ticks": text})
    assert survey.channels["time"] == {"column": "ticks", "unit": text}
    assert survey.duration == pytest.approx(T[-1], abs=2 * seconds)
    table = {"ticks": ticks, "x": Q, "u": U}
    units = {"ticks": text, "x": "rad", "u": "Nm"}
    experiment = td.experiment(
        table, axis="revolute", time="ticks", position="x", actuator_force="u", units=units
    )
    assert experiment.records[0].sample_time == pytest.approx(T[1], rel=1e-3)


@pytest.mark.parametrize(
    "text", ["8 kHz", "0 us", "-1 us", "1/0 s", "3 N", "12", "5 5 us", "2 rad"]
)
def test_other_numbers_before_a_unit_are_no_unit(text):
    with pytest.raises(ExperimentError, match='"125 us" for the ticks of a clock'):
        look({"ticks": 8e3 * T, "angle_rad": Q, "u [Nm]": U}, units={"ticks": text})


def test_several_times_a_unit_of_time_is_no_unit_of_a_position_or_of_a_column_by_name():
    with pytest.raises(ExperimentError, match="expected one of a position"):
        look({"t": T, "angle_rad": Q, "u [Nm]": U}, units={"angle_rad": "125 us"})
    assert not is_unit("10 ms"), "a name may say that there is a row every 10 ms"

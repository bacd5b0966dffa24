"""Columns that were read as what they are not, in logs of machines unlike the examples."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.stamp_unit import unit_in_place_of
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.survey.copies import repeats_mostly
from teleopdesign.measurement.survey.derivative import overflow_of
from teleopdesign.measurement.tables import open_log

STEP, ROWS = 0.01, 1200
T = STEP * np.arange(ROWS)


def survey(**columns):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices())


def servo():
    """A servo behind a sine: set point, angle a little later, current of inertia and friction."""
    wanted = 40.0 * np.sin(2 * np.pi * 0.25 * T) + 9.0 * np.sin(2 * np.pi * 0.6 * T)
    angle = np.interp(T - 0.06, T, wanted)
    rate = np.gradient(angle, T)
    noise = np.random.default_rng(4).standard_normal(ROWS)
    current = 3e-3 * np.gradient(rate, T) + 0.6 * np.tanh(rate / 5.0) + 0.08 * noise
    return np.round(wanted, 2), np.round(angle, 2), np.round(current, 3)


@pytest.mark.parametrize("slope", [-1.0, 4096 / 360.0])
def test_a_set_point_with_the_other_sign_or_unit_is_no_force(slope):
    """The steps of such a set point were the force, and `spring` was named with 0.7 % left."""
    wanted, angle, current = servo()
    again = np.round(slope * wanted, 2)
    again[:3] = 0.0  # the machine is switched on
    again[200::9] = again[199:-1:9]  # the two are not written in the same row
    columns = {"column 1": T, "column 2": wanted, "column 3": again, "column 4": angle}
    result = survey(**columns, **{"column 5": current})
    assert result.channels["position"]["column"] == "column 4"
    assert result.channels["actuator_force"]["column"] == "column 5"
    assert "set point 'column 2' in another unit" in result.unused["column 3"]
    with pytest.raises(ExperimentError, match="no column that could be a force"):
        survey(**columns)


def test_a_force_that_follows_a_set_point_is_no_copy_of_it():
    wanted, angle, current = servo()
    assert repeats_mostly(np.round(-2.0 * wanted, 2), wanted)
    assert not repeats_mostly(current, wanted)
    assert not repeats_mostly(np.round(wanted - angle, 2), wanted)
    assert not repeats_mostly(wanted, np.zeros(ROWS))


def test_a_commanded_speed_is_no_force_unless_it_is_chosen():
    """The held command of a joint's velocity was its torque: "the motion explains 97 %"."""
    _, angle, current = servo()
    speed = np.where(np.arange(ROWS) < 400, -9.0, -18.0)
    with pytest.raises(ExperimentError, match="--force 'roll/velocity' overrules"):
        survey(**{"time": T, "roll/position": angle, "roll/velocity": speed})
    log = {"time": T, "roll/position": angle, "roll/velocity": speed}
    opened = Log(tuple(log), lambda wanted: {n: log[n] for n in wanted})
    chosen = survey_log(opened, "log", Choices(actuator_force="roll/velocity"))
    assert chosen.channels["actuator_force"]["column"] == "roll/velocity"
    assert "actuator_force" in survey(time=T, angle=angle, v=current).channels, "v: a voltage"


@pytest.mark.parametrize(
    "name", ["load cell weight [g]", "AccX (g)", "Power (W)", "motor temp [°C]", "rate [Hz]"]
)
def test_a_unit_of_another_quantity_names_no_position(name):
    """Grams of a load cell and the acceleration of a bench were angles in deg and rad."""
    _, angle, current = servo()
    with pytest.raises(ExperimentError, match="found no position"):
        survey(**{"time [s]": T, name: angle, "brake torque [Nm]": current})


def test_a_potentiometer_in_millivolts_is_a_position():
    _, angle, current = servo()
    result = survey(**{"time [s]": T, "position [mV]": 20.0 * angle, "torque [Nm]": current})
    assert result.channels["position"]["column"] == "position [mV]"


def test_the_advice_for_a_speed_names_its_overflow():
    _, angle, current = servo()
    speed = 3.0 * np.gradient(angle, T)
    wrapped = (speed + 50.0) % 100.0 - 50.0
    assert overflow_of(wrapped) == pytest.approx(100.0, rel=0.1)
    assert overflow_of(speed) is None and overflow_of(np.sign(np.sin(200.0 * T))) is None
    names = "time [s]", "a1 velocity [deg/s]", "torque [Nm]"
    with pytest.raises(ExperimentError, match="integral of .* undo its leaps of 9"):
        survey(**dict(zip(names, (T, wrapped, current), strict=True)))
    with pytest.raises(ExperimentError, match=r"integral of 'a1 velocity \[deg/s\]'$"):
        survey(**dict(zip(names, (T, speed, current), strict=True)))


@pytest.mark.parametrize("name", ["time_us", "t [ns]"])
def test_a_name_with_an_impossible_unit_of_time_is_overruled_as_a_guess(name):
    """Seconds in a column "time_us" made a log of 6 s one of 6 us, which was refused."""
    _, angle, current = servo()
    result = survey(**{name: T, "angle_deg": angle, "torque": current})
    assert result.channels["time"] == {"column": name, "unit": "s"}
    assert "as its name says" in result.guesses["channels.time.unit"]


def test_a_unit_of_time_that_may_be_right_is_kept():
    _, angle, current = servo()
    columns = {"time_us": 100.0 * np.arange(ROWS), "angle_deg": angle, "torque": current}
    with pytest.raises(ExperimentError, match="'time_us' is read in us: --unit 'time_us=UNIT'"):
        survey(**columns)
    assert unit_in_place_of("us", np.arange(ROWS)) is None, "a scope of 1 MHz"
    assert unit_in_place_of("s", np.zeros(5)) is None
    columns["time_us"] = 1e6 * T
    assert survey(**columns).channels["time"]["unit"] == "us"
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    columns["time_us"] = T
    with pytest.raises(ExperimentError, match="of samples, expected at least 1 s$"):
        survey_log(log, "log", Choices(units={"time_us": "us"}))


def test_a_row_wider_than_the_header_is_refused_once_with_its_text(tmp_path):
    """The message repeated the row for each column, and called them columns without numbers."""
    path = tmp_path / "log.csv"
    _, angle, current = servo()
    rows = [f"LOG,{t:.3f},{q},{u}" for t, q, u in zip(T, angle, current, strict=True)]
    path.write_text("\n".join(["time,angle,torque", *rows]))
    expected = (
        "log.csv: row 1: found 4 cells, expected 3 as in the header; the header may leave out the "
        'name of a text ("LOG" in cell 1): write it there'
    )
    with pytest.raises(ExperimentError) as problem:
        survey_log(open_log(path, "log.csv"), "log.csv", Choices())
    assert str(problem.value) == expected
    path.write_text("\n".join(["time,angle", *(row[4:] for row in rows)]))
    with pytest.raises(ExperimentError, match="found 3 cells, expected 2 as in the header$"):
        survey_log(open_log(path, "log.csv"), "log.csv", Choices())


def test_a_message_about_a_log_without_position_names_columns_at_rest_and_without_name():
    _, _, current = servo()
    columns = {"": np.arange(ROWS), "time": T, "w": np.zeros(ROWS), "torque": current}
    with pytest.raises(ExperimentError, match=r'among "", w, torque \(w not changing\)'):
        survey(**columns)


def planned():
    """Position, velocity and acceleration of a path as a program plans it, and a drive's force."""
    path, rate, change = (
        sum(
            size * w**order * np.sin(w * T + order * np.pi / 2)
            for size, w in ((1.0, 1.9), (0.3, 5.3))
        )
        for order in range(3)
    )
    noise = 0.05 * np.random.default_rng(6).standard_normal(ROWS)
    return path, rate, change, 0.2 * change + 0.5 * np.sign(rate) + noise


def test_the_velocity_of_another_column_is_no_position():
    """Of position, velocity and acceleration, the velocity was the position, driven by it."""
    path, rate, change, force = planned()
    names = [f"column {k}" for k in range(1, 6)]
    result = survey(**dict(zip(names, (T, path, rate, change, force), strict=True)))
    assert result.channels["position"]["column"] == "column 2"
    assert "'column 3' is the derivative of 'column 2'" in result.notes
    assert result.channels["actuator_force"]["column"] == "column 5"
    assert result.unused["column 4"] == "an acceleration of 'column 2'"


def test_a_planned_path_has_no_force():
    """Nine rows of a planned path, of three joints, were a machine with 91 % of its force known."""
    path, rate, change, _ = planned()
    names = [f"column {k}" for k in range(1, 5)]
    with pytest.raises(ExperimentError, match="no column that could be a force"):
        survey(**dict(zip(names, (T, path, rate, change), strict=True)))
    other = path + np.sin(3.1 * T)
    more = other, np.gradient(other, T), np.gradient(np.gradient(other, T), T)
    names += [f"column {k}" for k in range(5, 8)]
    with pytest.raises(ExperimentError, match="no column that could be a force"):
        survey(**dict(zip(names, (T, path, rate, change, *more), strict=True)))


@pytest.mark.parametrize("name", ["acceleration", "qdd", "acc_x", "joint acc (rad/s2)"])
def test_an_acceleration_by_name_is_no_force(name):
    path, _, change, force = planned()
    noise = 0.3 * np.random.default_rng(7).standard_normal(ROWS)
    with pytest.raises(ExperimentError, match="no column that could be a force"):
        survey(**{"time": T, "angle": path, name: change + noise})
    result = survey(**{"time": T, "angle": path, name: change + noise, "torque": force})
    assert result.channels["actuator_force"]["column"] == "torque"

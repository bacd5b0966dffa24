"""Set points in a log: neither the position nor a force, whatever their names."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.survey.content import SurveyedColumn
from teleopdesign.measurement.survey.set_point import (
    follows,
    has_numbers_of,
    is_sent_to_places,
    lags,
    settles_at,
)

T = 0.01 * np.arange(1500)
WANTED = 40.0 * np.sign(np.sin(1.3 * T)) + 15.0 * np.sin(2.9 * T)


def look(columns, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted}, remarks=())
    return survey_log(log, "log", Choices(**choices))


def column_of(name, values):
    """A column without a unit, as a survey holds it."""
    return SurveyedColumn(name, values, values, None)


def controlled():
    """Position (deg) and command of a motor under a position loop."""
    place = speed = 0.0
    rows = []
    for wanted in WANTED:
        force = float(np.clip(0.03 * (wanted - place) - 0.001 * speed, -1.0, 1.0))
        rows.append((place, force))
        for _ in range(10):
            speed += 0.001 * (force - 0.05 * np.tanh(speed) - 2e-4 * speed) / 3.5e-5
            place += 0.001 * speed
    return np.array(rows).T


PLACE, FORCE = controlled()


@pytest.mark.parametrize(
    ("names", "position", "force"),
    [
        ("r y u", "y", "u"),
        ("SV PV MV", "PV", "MV"),
        ("Setpoint Input Output", "Input", "Output"),
        ("reference measurement voltage", "measurement", "voltage"),
        ("w x y", "x", "y"),
        ("yd y u", "y", "u"),
        ("goal present load", "present", "load"),
        ("command encoder pwm", "encoder", "pwm"),
    ],
)
def test_a_set_point_is_neither_the_position_nor_a_force(names, position, force):
    columns = dict(zip(names.split(), (WANTED, PLACE, FORCE), strict=True))
    survey = look({"t": T, **columns})
    assert survey.channels["position"]["column"] == position
    assert survey.channels["actuator_force"]["column"] == force
    assert "interaction_force" not in survey.channels
    assert names.split()[0] in survey.unused


@pytest.mark.parametrize(
    ("first", "second", "position"),
    [
        ({"r": WANTED, "e": WANTED - PLACE}, {"y": PLACE, "u": FORCE}, "y"),
        ({"e": WANTED - PLACE}, {"u": FORCE, "y": PLACE}, "y"),
        ({"input": FORCE}, {"output": PLACE}, "output"),
        ({"CH1": FORCE, "CH2": WANTED}, {"CH3": PLACE}, "CH3"),
    ],
)
def test_of_columns_without_names_the_motion_explains_a_force(first, second, position):
    survey = look({"t": T, **first, **second})
    assert survey.channels["position"]["column"] == position
    assert "channels.position.column" in survey.guesses
    assert np.array_equal(survey.columns[survey.channels["actuator_force"]["column"]].values, FORCE)


def test_the_reason_names_the_set_point():
    survey = look({"t": T, "r": WANTED, "y": PLACE, "u": FORCE})
    assert "it follows 'r'" in survey.guesses["channels.position.column"]
    assert survey.unused["r"] == "a set point: 'y' follows it"


@pytest.mark.parametrize("delay", [1, 7, 60])
def test_a_column_follows_one_that_has_its_numbers_earlier(delay):
    late = np.r_[np.full(delay, WANTED[0]), WANTED[:-delay]]
    assert follows(late, WANTED) and not follows(WANTED, late)
    assert has_numbers_of(late, WANTED) and has_numbers_of(WANTED, late)
    assert not follows(0.4 * late, WANTED), "a gear lies between"
    assert not follows(late + 100.0, WANTED)


def test_equal_columns_follow_none_of_the_other_and_a_force_has_other_numbers():
    assert not follows(WANTED, WANTED.copy()) and has_numbers_of(WANTED, WANTED.copy())
    assert not has_numbers_of(FORCE, PLACE) and not has_numbers_of(np.ones(1500), PLACE)


def test_a_force_by_its_name_or_unit_stays_one_where_a_spring_gives_it_the_numbers_of_a_position():
    late = np.r_[WANTED[:3], WANTED[:-3]]
    for name in ("torque", "a [Nm]"):
        survey = look({"t": T, "angle [rad]": late, name: WANTED})
        assert survey.channels["actuator_force"]["column"] == name


def planned():
    """Set point, planned path, position, speed and current of a drive that plans its path."""
    wanted = np.array([40.0, -30.0, 25.0, -45.0, 10.0, 10.0])[(T / 2.5).astype(int)]
    path, place, speed = [0.0], [0.0], [0.0]
    for goal in wanted[1:]:
        path.append(path[-1] + float(np.clip(goal - path[-1], -0.3, 0.3)))
        speed.append(speed[-1] + 0.5 * (path[-1] - place[-1] - 0.6 * speed[-1]))
        place.append(place[-1] + 0.6 * speed[-1])
    speed = np.array(speed)
    current = 0.02 * np.gradient(speed, 0.01) + 0.05 * speed + 0.8 * np.tanh(20.0 * speed)
    noise = 0.6 * np.random.default_rng(1).standard_normal(len(T))
    return wanted, np.array(path), np.round(place, 2), np.round(60.0 * speed, 1), current + noise


def test_steps_of_a_set_point_that_a_drive_reaches_by_a_planned_path_are_no_force():
    columns = {f"column {k + 2}": values for k, values in enumerate(planned())}
    survey = look({"t": T, **columns})
    assert survey.channels["position"]["column"] == "column 4"
    assert survey.channels["actuator_force"]["column"] == "column 6"
    assert survey.unused["column 2"] == "a set point: 'column 4' follows it"
    assert survey.unused["column 3"].startswith("has the numbers of 'column 4'")


def test_a_position_lags_behind_its_planned_path_by_less_than_a_row():
    path = np.cumsum(np.sin(2.0 * T))
    late = 0.6 * path + 0.4 * np.r_[path[0], path[:-1]]
    assert lags(late, path) and not lags(path, late) and not lags(path, path.copy())


def test_a_position_settles_at_steps_of_its_set_point_and_a_relay_switches_in_motion():
    wanted, path, *_ = planned()
    assert settles_at(path, wanted) and not settles_at(wanted, path)
    assert not settles_at(path[:500], wanted[:500]), "two holds"
    swing = np.sin(3.0 * T)
    assert not settles_at(swing, -np.sign(swing)), "a relay"
    assert not settles_at(0.3 * path, wanted), "a gear lies between"


def sent_by_pulses(low=1200.0, high=1800.0, levels=2):
    """Pulse width and angle (deg) of a hobby servo that is sent to two places, or to several."""
    steps = np.random.default_rng(3).integers(0, levels, 15) if levels > 2 else np.arange(15) % 2
    pulse = low + (high - low) * steps[(T // 1.0).astype(int)] / (levels - 1)
    angle = [20.0]
    for wanted in 0.1 * (pulse[:-1] - low) + 20.0:
        angle.append(angle[-1] + float(np.clip(0.2 * (wanted - angle[-1]), -2.0, 2.0)))
    return pulse, np.round(angle, 1)


@pytest.mark.parametrize("name", ["pwm", "cmd", "u", "servo", "column 2"])
@pytest.mark.parametrize("levels", [2, 5])
def test_the_pulses_of_a_servo_that_rests_at_a_place_for_each_of_them_are_no_force(name, levels):
    pulse, angle = sent_by_pulses(levels=levels)
    assert is_sent_to_places(angle, column_of(name, pulse))
    with pytest.raises(ExperimentError, match=f"--force '{name}' overrules this"):
        look({"t": T, name: pulse, "angle [deg]": angle})
    survey = look({"t": T, name: pulse, "angle [deg]": angle}, actuator_force=name)
    assert survey.channels["actuator_force"]["column"] == name, "the user knows"


def test_forces_about_zero_and_forces_by_name_or_unit_may_hold_a_body_at_places():
    pulse, angle = sent_by_pulses()
    assert not is_sent_to_places(angle, column_of("pwm", pulse - 1500.0)), "a spring"
    assert not is_sent_to_places(angle, column_of("pwm", pulse - 1200.0)), "from rest to a place"
    for name in ("torque", "current", "pwm [N m]"):
        survey = look({"t": T, name: pulse, "angle [deg]": angle})
        assert survey.channels["actuator_force"]["column"] == name
    assert not is_sent_to_places(np.cumsum(pulse - 1500.0), column_of("pwm", pulse)), (
        "it never rests"
    )
    swing = np.sin(3.0 * T)
    assert not is_sent_to_places(swing, column_of("u", 3.0 - np.sign(swing))), "a relay"


def test_the_reason_names_the_pulses_beside_another_force():
    pulse, angle = sent_by_pulses()
    survey = look({"t": T, "pwm": pulse, "angle [deg]": angle, "load [mA]": np.gradient(angle)})
    assert survey.channels["actuator_force"]["column"] == "load [mA]"
    assert survey.unused["pwm"].startswith("a set point: 'angle [deg]' rests at a place")

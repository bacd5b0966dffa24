"""Columns of a log without a header: which is the time, and which the angle of a motor one way."""

import numpy as np
import pytest
from measurement.columns_by_hand import look

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.survey.axes import (
    axis_that_moves,
    has_sibling,
    of_another_axis,
    same_but_axis,
)
from teleopdesign.measurement.survey.candidate_clocks import clock_without_name
from teleopdesign.measurement.survey.derivative import DERIVATIVE, is_mean_rate, rate_agreement

RNG = np.random.default_rng(3)
#: stamps of a reader that come late or early by a third of a row
STAMPS = 0.2 + 0.02 * (np.arange(300) + 0.3 * RNG.random(300))
SPEED = 12.0 + 1.5 * np.sin(2 * np.pi * 3.1 * STAMPS) + 0.3 * RNG.standard_normal(300)
#: the angle was read at another moment than its stamp says
ANGLE = np.cumsum(12.0 * 0.02 * (1.0 + 0.9 * RNG.uniform(-1, 1, 300)))
H = 0.02
VOLTAGE = 0.3 + 0.1 * np.gradient(ANGLE, H)


def numbered(*columns):
    return look({f"column {k}": x for k, x in enumerate(columns, start=1)})


def used(survey):
    return {key: entry.get("column") for key, entry in survey.channels.items()}


def test_the_time_rises_most_evenly_and_the_angle_at_the_mean_of_the_speed():
    survey = numbered(np.full(300, 12.0), VOLTAGE, SPEED, ANGLE, STAMPS)
    expected = {"time": "column 5", "position": "column 4", "actuator_force": "column 2"}
    assert used(survey) == expected
    assert survey.guesses["channels.time.column"] == (
        "'column 5' is read as the time: it is the column that rises most evenly"
    )
    assert survey.unused["column 3"].startswith("the velocity of 'column 4'")


def test_the_first_column_that_rises_is_the_time_unless_another_is_far_more_even():
    rows = np.arange(300.0)
    assert used(numbered(STAMPS, VOLTAGE, SPEED, ANGLE))["time"] == "column 1"
    assert used(numbered(STAMPS, rows, VOLTAGE, SPEED, ANGLE))["time"] == "column 1"
    # as even but for a third: both may be the time
    later = STAMPS + 0.002 * RNG.random(300)
    assert used(numbered(later, VOLTAGE, SPEED, STAMPS, ANGLE))["time"] == "column 1"


def test_stamps_beside_a_count_of_rows_are_the_time():
    """The rows were taken for milliseconds, although the microseconds stood beside them."""
    rows = np.arange(1200.0)
    stamps = 88.0 + 5090 * rows + 4 * RNG.integers(-3, 4, 1200)
    position = np.sin(0.05 * rows) + 0.2 * np.sin(0.17 * rows)
    force = np.gradient(np.gradient(position)) + 1e-3 * np.sign(np.gradient(position))
    survey = numbered(rows, force, stamps, position)
    assert used(survey)["time"] == "column 3"
    assert survey.channels["time"]["unit"] == "us"
    assert survey.guesses["channels.time.column"] == (
        "'column 3' is read as the time: it is as even as a clock, beside 'column 1', which counts "
        "the rows"
    )
    assert "column 1" in survey.unused
    # counts of a motor that speeds up; and three columns, of which no position would be left
    counts = np.round(np.cumsum(100.0 + 0.1 * rows))
    assert clock_without_name({"rows": rows, "counts": counts}, 4)[0] == "rows"
    assert clock_without_name({"rows": rows, "stamps": stamps}, 3)[0] == "rows"
    assert clock_without_name({"rows": rows, "stamps": stamps}, 4)[0] == "stamps"


def test_a_command_that_is_constant_in_the_first_log_is_chosen_by_its_name():
    t = 0.01 * np.arange(300)
    columns = t, np.full(300, -70.0), np.sin(3.0 * t) + 0.3 * np.sin(7.0 * t)
    with pytest.raises(ExperimentError, match="'?column 2'? does not change here: --force"):
        numbered(*columns)
    table = {f"column {k}": x for k, x in enumerate(columns, start=1)}
    assert used(look(table, actuator_force="column 2"))["actuator_force"] == "column 2"


def test_a_speed_about_its_mean_is_that_of_a_motion_one_way():
    assert rate_agreement(ANGLE, SPEED, H) == 1.0 > DERIVATIVE
    for unit in (60.0, 60.0 / (2 * np.pi), 1 / 6.0):  # turns, rad and deg beside rpm
        assert is_mean_rate(ANGLE, unit * SPEED, H)
    assert is_mean_rate(-ANGLE, -SPEED, H)
    assert not is_mean_rate(-ANGLE, SPEED, H)
    assert not is_mean_rate(ANGLE, 1.2 * SPEED, H)
    assert not is_mean_rate(ANGLE, SPEED + 8.0 * RNG.standard_normal(300), H), (
        "more noise than speed"
    )
    assert not is_mean_rate(np.r_[ANGLE, ANGLE[::-1]], np.r_[SPEED, SPEED], H), "there and back"


@pytest.mark.parametrize(
    ("one", "other", "apart"),
    [
        ("column 2", "column 3", False),
        ("(2)", "(3)", False),
        ("CH1", "CH2", False),
        ("signal_1", "signal_2", False),
        ("1", "2", False),
        ("q(2)", "tau(3)", True),
        ("joint1", "joint2", True),
        ("ODrive2Position", "ODrive3Current", True),
        ("ODrive2Position", "ODrive2Current", False),
    ],
)
def test_numbers_of_columns_count_no_axes(one, other, apart):
    assert of_another_axis(one, other) == apart


@pytest.mark.parametrize(("one", "other"), [("joint1", "joint2"), ("q_2 (rad)", "q_1 (rad)")])
def test_the_position_of_another_joint_is_no_force(one, other):
    """Two joints that move together explain each other's motion."""
    t = 0.01 * np.arange(900)
    q = np.sin(3.0 * t) + 0.2 * np.sin(8.0 * t)
    twice = {"t": t, one: q, other: 0.1 * np.sign(np.cos(3.0 * t)) + 0.02 * q}
    with pytest.raises(ExperimentError, match="found no column that could be a force"):
        look(twice)
    assert used(look({**twice, "tau": twice[other]}))["actuator_force"] == "tau"
    # numbered columns of a logger may be anything
    assert used(look({"t": t, "CH1": q, "CH2": 0.1 * np.gradient(np.gradient(q, t), t)}))
    assert not same_but_axis("joint1", "joint1") and not same_but_axis("q1", "tau2")


def test_of_several_motors_the_one_that_moves_is_read():
    """Four winches: one lifts a load, three hold their places within their encoders' noise."""
    t = np.arange(600) / 100.0
    noise = np.random.default_rng(2).standard_normal((9, len(t)))
    lifts = np.sin(2.0 * t) ** 2
    table = {"time": t}
    for k in range(4):
        table[f"Drive{k}Position"] = 1.0 + 1e-5 * noise[k] if k != 2 else lifts
    for k in range(4):
        moves = np.gradient(table[f"Drive{k}Position"], t)
        table[f"Drive{k}Velocity"] = moves + 1e-4 * noise[k + 4]
    for k in range(4):
        table[f"Drive{k}Current"] = 0.2 + 0.0 * t if k != 2 else 3.0 + np.sign(np.sin(4.0 * t))
    survey = look(table)
    chosen = {k: survey.channels[k]["column"] for k in ("position", "actuator_force")}
    assert chosen == {"position": "Drive2Position", "actuator_force": "Drive2Current"}
    assert survey.notes == ["'Drive2Velocity' is the derivative of 'Drive2Position'"]


def test_a_joint_rests_beside_one_that_travels_thirty_times_as_far():
    travels = {"q1": 1.0, "q2": 29.0, "q3": 31.0, "x9": 1e3}
    assert axis_that_moves("q1", ["q2"], travels) == "q1"
    assert axis_that_moves("q1", ["q2", "q3"], travels) == "q3"
    assert axis_that_moves("q1", ["x9"], travels) == "q1", "another quantity"
    names = ["J1_pos", "J1_vel", "J2_pos", "J2_vel"]
    assert has_sibling("J1_pos", "J2_vel", names)
    assert not has_sibling("J1_pos", "J1_vel", names)
    assert not has_sibling("x1", "x2", ["x1", "x2"]), "a position and its rate, numbered"

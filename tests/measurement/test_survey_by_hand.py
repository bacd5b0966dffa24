"""What a survey writes and says of a log: wraps, units of another axis, doubts among columns."""

import re

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.survey.acting import current_that_acted
from teleopdesign.measurement.survey.content import SurveyedColumn, explain_ambiguity, reasons

T = 0.005 * np.arange(1200)
Q = np.sin(2 * np.pi * 0.7 * T) + 0.2 * np.sin(2 * np.pi * 2.1 * T)
U = 0.02 * np.gradient(np.gradient(Q, T), T) + 0.3 * np.sign(np.gradient(Q, T))


def look(columns, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted}, remarks=())
    return survey_log(log, "log", Choices(**choices))


@pytest.mark.parametrize(
    ("name", "turn", "period", "unwrap"),
    [
        ("angle [deg]", 360.0, 360.0, True),
        ("angle [rad]", 2 * np.pi, 2 * np.pi, True),
        ("angle [deg]", 360.0, 180.0, 180.0),  # a sensor that repeats within the turn
        ("encoder [counts]", 4096.0, 4096.0, 4096.0),
    ],
)
def test_an_angle_that_wraps_at_a_turn_is_written_so_and_others_with_their_period(
    name, turn, period, unwrap
):
    wrapped = np.mod(2.0 * Q / (2 * np.pi) * turn, period)
    if turn == 4096.0:
        wrapped = np.floor(wrapped)
    survey = look({"t [s]": T, name: wrapped, "torque [Nm]": U})
    assert survey.channels["position"]["unwrap"] == pytest.approx(unwrap)
    assert (survey.channels["position"]["unwrap"] is True) == (unwrap is True)
    assert f"{name!r} wraps at {period:g}" in survey.notes


@pytest.mark.parametrize("axis", ["revolute", "prismatic"])
def test_a_velocity_in_units_of_another_axis_says_no_unit_of_the_position(axis):
    rate = np.gradient(Q, T)
    survey = look({"t": T, "pos": Q, "v [mm/s]": rate, "u": U}, axis=axis)
    assert survey.channels["position"]["unit"] == ("rad" if axis == "revolute" else "mm")
    assert ("agrees with" in survey.guesses["channels.position.unit"]) == (axis == "prismatic")
    assert ("velocity" in survey.channels) == (axis == "prismatic")


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("a", "it is the first column that moves"),
        ("a [rad]", "name or unit suggest a position"),
        ("a (counts)", "name or unit suggest a position"),
    ],
)
def test_a_doubtful_position_says_what_speaks_for_it(name, why):
    survey = look({"t": T, name: Q, "tau": U})
    guess = survey.guesses["channels.position.column"]
    assert guess == f"{name!r} is read as the position: {why}"
    beside = look({"t": T, name: Q, "b": np.gradient(Q, T), "tau": U})
    assert "another column is its derivative" in beside.guesses["channels.position.column"]


def test_one_of_two_forces_alike_is_a_guess_and_one_alone_is_none():
    key = "channels.actuator_force.column"
    alone = {"t [s]": T, "q [rad]": Q, "torque_a [Nm]": U}
    assert key not in look(alone).guesses
    noise = 0.05 * np.random.default_rng(0).normal(size=len(T))
    both = look(alone | {"torque_b [Nm]": U + noise})
    assert "'torque_b [Nm]' may be the actuator's force as well" in both.guesses[key]


@pytest.mark.parametrize("unit", ["K", "rad/s", "rad", "Hz"])
def test_a_column_in_units_of_no_force_is_none_whatever_the_motion_explains(unit):
    log = {"t [s]": T, "q [rad]": Q, f"x [{unit}]": U}
    with pytest.raises(ExperimentError, match="found no column that could be a force"):
        look(log)
    survey = look(log | {"i [A]": U + 2.0 * np.random.default_rng(0).normal(size=len(T))})
    assert survey.channels["actuator_force"]["column"] == "i [A]"


def test_long_lists_of_columns_end_in_dots_and_short_ones_do_not():
    for many in (1, 3, 4, 9):
        names = [f"c{k}" for k in range(many)]
        sentence = explain_ambiguity("a", names, "the force")
        assert ("..." in sentence) == (many > 3) and sentence.count("'c") == min(many, 3)
        why = reasons(dict.fromkeys(names, "text"))
        assert ("..." in why) == (many > 3) and why.count("text") == min(many, 3)
    assert reasons({}) == ""


@pytest.mark.parametrize("step", [9.1309234e-6, 2 * np.pi / 4096, 0.01])
def test_a_step_is_written_with_the_digits_that_keep_readings_on_its_grid(step):
    resolution = look({"t": T, "angle [rad]": step * np.round(Q / step), "tau": U})
    resolution = resolution.channels["position"]["resolution"]
    reach = np.ptp(Q)
    assert abs(resolution / step - 1.0) * reach < 0.1 * step
    assert float(f"{resolution:.6g}") == resolution, "no more digits than needed"


SIGNED = np.round(400.0 * np.cos(2 * np.pi * 0.7 * T))


@pytest.mark.parametrize(
    ("readings", "code"),
    [
        (np.where(SIGNED < 0, 1024.0 - SIGNED, SIGNED), ("sign_bit", 10)),
        (np.where(SIGNED < 0, 65536.0 + SIGNED, SIGNED), ("twos_complement", 16)),
        (np.where(SIGNED < 0, 4096.0 + SIGNED, SIGNED), ("twos_complement", 12)),
        (np.where(SIGNED < 0, 2.0**32 + SIGNED, SIGNED), ("twos_complement", 32)),
        (SIGNED, None),
        (SIGNED + 512.0, None),
        (np.abs(SIGNED), None),
        (np.where(SIGNED < 0, 0.0, 200.0), None),
        (np.where(SIGNED < 0, 65535.0, 1.0), None),
    ],
)
def test_numbers_without_their_sign_are_decoded_as_a_guess(readings, code):
    survey = look({"t": T, "angle [rad]": Q, "torque": readings})
    entry = survey.channels["actuator_force"]
    keys = {"sign_bit", "twos_complement"} & set(entry)
    assert keys == ({code[0]} if code else set())
    if code is not None:
        assert entry[code[0]] == code[1]
        why = survey.guesses[f"channels.actuator_force.{code[0]}"]
        assert (
            f"{readings.max() if code[0] == 'sign_bit' else 2.0 ** code[1] - 400:.0f} for -400"
            in why
        )
        np.testing.assert_array_equal(survey.columns["torque"].readings, SIGNED)


def test_a_bus_servo_is_read_by_the_signed_load_of_the_axis():
    """Brackets count the axes; the current is a size, the load has its sign in a bit."""

    def servo(k, phase):
        at = 2 * np.pi * 0.7 * T + phase
        load = np.round(100.0 * np.sign(np.cos(at)) - 60.0 * np.sin(at))
        return {
            f"pos ({k})": np.round(2000.0 + 200.0 * np.sin(at)),
            f"load ({k})": np.where(load < 0, 1024.0 - load, load),
            f"current ({k})": np.round(np.abs(load) / 10.0),
        }

    survey = look({"t": T, **servo(4, 0.0), **servo(5, 1.0)}, position="pos (5)")
    assert survey.channels["actuator_force"]["column"] == "load (5)"
    assert survey.channels["actuator_force"]["sign_bit"] == 10
    assert "interaction_force" not in survey.channels
    assert "of another axis" in survey.unused["load (4)"]


def acted(wanted, measured):
    columns = {
        "torque_cmd": SurveyedColumn("torque_cmd", wanted, wanted, None),
        "motor_current": SurveyedColumn("motor_current", measured, measured, None),
    }
    return current_that_acted("torque_cmd", columns, {"torque_cmd": 1.0, "motor_current": 0.9})


@pytest.mark.parametrize("apart", [0.05, 0.15, 0.5, 0.9])
@pytest.mark.parametrize("late", [0, 3])
def test_a_current_acted_by_the_part_of_it_that_was_not_wanted(apart, late):
    """In any unit, delayed, with noise of single rows: what else the motor did in slow waves."""
    noise = 0.05 * np.random.default_rng(0).normal(size=len(T))
    wanted, other = np.sin(2 * np.pi * 1.0 * T), np.cos(2 * np.pi * 1.5 * T)
    measured = 7.0 * ((1 - apart**2) ** 0.5 * np.roll(wanted, late) + apart * other) + noise + 2.0
    if apart < 0.1:  # a hundredth of the squares
        assert acted(wanted, measured) is None
    else:
        column, share = acted(wanted, measured)
        assert column == "motor_current" and share == pytest.approx(apart, abs=0.02)


def test_a_current_that_stays_and_one_of_a_few_rows_did_not_act():
    assert acted(U, np.full(len(T), 2.0)) is None
    assert acted(U[:8], Q[:8]) is None


def test_a_column_left_out_says_what_the_motion_explains_of_it_and_of_what_was_taken():
    noise = np.random.default_rng(0).normal(size=len(T))
    log = {"t [s]": T, "q [rad]": Q, "torque_a [Nm]": U, "torque_b [Nm]": U + noise, "c": noise}
    unused = look(log).unused
    of_force = r": the motion explains (\d+)% of it, and (9\d|100)% of 'torque_a \[Nm\]'"
    second = re.fullmatch(
        "a second force beside 'torque_a \\[Nm\\]'" + of_force, unused["torque_b [Nm]"]
    )
    nothing = re.fullmatch("its name is not that of a force" + of_force, unused["c"])
    assert second and nothing and int(nothing[1]) < int(second[1]) < 100


@pytest.mark.parametrize(("counts", "message"), [(2000, 2000), (2600, 4096), (3333, 4096)])
def test_counts_of_a_turn_that_no_encoder_has_are_not_read_off_a_velocity(counts, message):
    columns = {
        "t": T,
        "pos [inc]": np.round(3.0 * counts * Q),
        "v [rpm]": 180.0 * np.gradient(Q, T),
    }
    survey = look(columns | {"current [mA]": U})
    assert survey.channels["position"]["counts_per_turn"] == message
    why = survey.guesses["channels.position.counts_per_turn"]
    assert ("agrees with" in why) == (message == counts)
    assert ("see the data sheet of the encoder" in why) == (message != counts)

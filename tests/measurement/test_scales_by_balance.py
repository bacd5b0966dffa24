"""Constants that no name says are read off the balance of two forces: a motor's, and a gear's."""

import numpy as np
import pytest
from joint_simulator import simulate_joint

from teleopdesign.commands.new import survey_text
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.first_guess import balance_factor
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.survey.remarks import gear_ratio_in

CONSTANT, GEAR = 0.052, 50.0  # N*m/A, turns of the motor per turn


@pytest.fixture(scope="module")
def joint():
    return simulate_joint(8)


def look(columns, remarks=(), **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted}, remarks=remarks)
    return survey_log(log, "log", Choices(**choices))


def in_amperes(joint, hand="hand (Nm)", sign=1.0):
    columns = {"t": joint["t"], "pos (rad)": joint["q"], "current (A)": joint["u"] / CONSTANT}
    return columns | {hand: sign * joint["hand"]}


@pytest.mark.parametrize("factor", [1.0, -0.02, 37.0])
def test_a_factor_between_two_forces_is_estimated_within_its_error(joint, factor):
    """Static friction that falls with speed is not in the balance, but its rows are left out."""
    estimate, error = balance_factor(joint["u"], joint["hand"] / factor, joint["q"], 1e-3)
    assert abs(estimate - factor) < 2 * error < 0.1 * abs(factor)


@pytest.mark.parametrize("rest", [slice(0, 900), slice(0, 0)])
def test_no_factor_is_detected_where_hardly_anything_moves(joint, rest):
    q = np.zeros(len(joint["q"]))
    q[rest] = joint["q"][rest]
    assert balance_factor(joint["u"], joint["hand"], q, 1e-3) == (0.0, np.inf)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_constant_of_a_motor_is_read_off_the_balance_with_the_hands_force(joint, sign):
    survey = look(in_amperes(joint, sign=sign))
    force = survey.channels["actuator_force"]
    assert force["torque_constant"]["value"] == pytest.approx(CONSTANT, rel=0.03)
    assert "balances 'hand (Nm)'" in survey_text(survey, "log")
    assert survey.channels["interaction_force"].get("sign", 1) == sign


def test_a_stated_constant_stands(joint):
    survey = look(in_amperes(joint), torque_constant=(0.06, "N*m/A"))
    assert survey.channels["actuator_force"]["torque_constant"]["value"] == 0.06
    assert "channels.actuator_force.torque_constant" not in survey.guesses
    above = look(in_amperes(joint), remarks=("kt = 0.06 Nm/A",))
    assert above.channels["actuator_force"]["torque_constant"]["value"] == 0.06


def test_without_a_hand_a_constant_stays_open(joint):
    survey = look({n: v for n, v in in_amperes(joint).items() if "hand" not in n})
    assert survey.channels["actuator_force"]["torque_constant"]["value"] == 1.0
    assert "state the true constant" in survey.guesses["channels.actuator_force.torque_constant"]


@pytest.mark.parametrize("name", ["tcp_torque", "tipforce", "Endkraft", "tau2"])
def test_a_torque_that_no_name_calls_the_hands_is_detected_beside_a_current(joint, name):
    survey = look(in_amperes(joint, hand=name))
    assert survey.channels["interaction_force"]["column"] == name
    constant = survey.channels["actuator_force"]["torque_constant"]["value"]
    assert constant == pytest.approx(CONSTANT, rel=0.03)


def test_what_is_no_force_by_its_name_is_not_taken_beside_a_current(joint):
    """A voltage balances the current with the motion as its rest: R i = U - k v."""
    v = np.gradient(joint["q"], joint["t"])
    u = joint["u"] / CONSTANT
    columns = {n: x for n, x in in_amperes(joint).items() if "hand" not in n}
    volts = 2.0 * u + 0.05 * v
    names = ("bus", "u_motor_V", "u", "command", "motor torque", "effort")
    survey = look(columns | dict.fromkeys(names, volts))
    assert "interaction_force" not in survey.channels


def of_the_motor(joint, **names):
    q, u = (names.get(k, d) for k, d in (("q", "motor angle (deg)"), ("u", "motor torque (mNm)")))
    columns = {"t": joint["t"], q: np.rad2deg(joint["q"]) * GEAR, u: 1e3 * joint["u"] / GEAR}
    return columns | {"load torque (Nm)": joint["hand"]}


@pytest.mark.parametrize("remarks", [(), ("# gear 50:1",)])
def test_a_gear_between_the_motor_and_the_joint_is_a_guess(joint, remarks):
    survey = look(of_the_motor(joint), remarks)
    for key in ("position", "actuator_force"):
        assert survey.channels[key]["gear_ratio"] == GEAR
    assert "--gear-ratio N" in survey_text(survey, "log")
    assert survey.first.inertia == pytest.approx(0.012, rel=0.1)


def test_a_stated_gear_stands(joint):
    survey = look(of_the_motor(joint), ("# gear 50:1",), gear_ratio=1.0)
    assert survey.channels["position"]["gear_ratio"] == 1.0
    assert "channels.position.gear_ratio" not in survey.guesses


def test_forces_of_two_scales_are_reported_where_no_name_says_which_side(joint):
    survey = look(of_the_motor(joint, q="angle (deg)"))
    assert "gear_ratio" not in survey.channels["position"]
    (note,) = [n for n in survey.notes if "only with a factor of" in n]
    assert "--unit" in note and "--gear-ratio" in note


@pytest.mark.parametrize(("factor", "is_noted"), [(1.1, False), (0.85, False), (1.5, True)])
def test_a_calibration_may_err_by_a_quarter_and_no_more(joint, factor, is_noted):
    columns = {"t": joint["t"], "angle (rad)": joint["q"], "torque (Nm)": joint["u"] / factor}
    survey = look(columns | {"hand (Nm)": joint["hand"]})
    assert any("only with a factor of" in n for n in survey.notes) == is_noted


@pytest.mark.parametrize(
    ("line", "ratio"),
    [
        ("gear 50:1", 50), ("# gear ratio = 100", 100), ("Getriebe i = 3,5:1", 3.5),
        ("gearbox: 12.25", 12.25), ("Untersetzung 80 : 1", 80), ("gear 1:50", None),
        ("geared motor", None), ("gear none", None), ("gear made 2026-03-02", None),
    ],
)  # fmt: skip
def test_a_gear_in_a_line_above_the_table(line, ratio):
    reading = gear_ratio_in((line,))
    assert (None if reading is None else reading[0]) == ratio

"""What a survey takes for which quantity: several axes, wheels, constants above a table."""

import numpy as np
import pytest
from shared_data import shared_folder

from teleopdesign.base.errors import ExperimentError
from teleopdesign.commands.new import survey_text
from teleopdesign.measurement import load_experiment
from teleopdesign.measurement.column_names import likeness
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.first_guess import explain_force, is_turned
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.survey.forces import DRIVES
from teleopdesign.measurement.survey.remarks import counts_per_turn_in, torque_constant_in

ROWS = 1200
T = 0.005 * np.arange(ROWS)


def joint(phase):
    """Angle (rad) and torque (N*m) of a joint with friction; joints of other phases move alike."""
    q = np.sin(2 * np.pi * 0.7 * T + phase) + 0.2 * np.sin(2 * np.pi * 2.1 * T)
    return q, 0.02 * np.gradient(np.gradient(q, T), T) + 0.3 * np.sign(np.gradient(q, T))


Q, U = joint(0.0)


def look(columns, remarks=(), **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted}, remarks=remarks)
    return survey_log(log, "log", Choices(**choices))


@pytest.mark.parametrize(
    "names",
    [
        "J{}_pos_deg J{}_cur_A", "angle {} [deg];torque {} [Nm]", "q{} tau{}",
        "r/axis({})/q r/axis({})/u",
        "arm.joint{}.position arm.joint{}.effort",
    ],
)  # fmt: skip
@pytest.mark.parametrize("axis", [1, 2])
def test_a_force_of_another_axis_is_not_taken(names, axis):
    """The second force is noisy: physics alone would take the first one for either axis."""
    names = names.split(";") if ";" in names else names.split()
    columns = {"t": T}
    for k, noise in ((1, 0.0), (2, 1.0)):
        q, u = joint(0.05 * k)
        shaken = u + noise * np.random.default_rng(k).standard_normal(ROWS)
        columns |= {names[0].format(k): np.rad2deg(q), names[1].format(k): shaken}
    survey = look(columns, position=names[0].format(axis), axis="revolute")
    assert survey.channels["actuator_force"]["column"] == names[1].format(axis)


def test_the_angle_of_a_wheel_that_only_turns_forward_is_a_position():
    q = 3.0 * T + 0.3 * np.sin(2 * np.pi * 0.7 * T)
    survey = look({"t_s": T, "angle_deg": np.rad2deg(q), "current_A": U})
    assert survey.channels["position"]["column"] == "angle_deg"
    assert survey.channels["time"]["column"] == "t_s"


@pytest.mark.parametrize(
    ("name", "unit"),
    [("ODrive 3 Position", "turns"), ("moteus_position", "turns"), ("motor position", "rad")],
)
def test_what_a_motor_reports_turns(name, unit):
    survey = look({"time": T, name: Q, "current": U})
    assert survey.axis == "revolute" and survey.channels["position"]["unit"] == unit
    assert "channels.position.unit" in survey.guesses


@pytest.mark.parametrize("name", ["torque", "tau", "effort", "Drehmoment"])
def test_a_torque_turns_what_it_drives(name):
    survey = look({"time": T, "position": Q, name: U})
    assert survey.axis == "revolute" and survey.channels["actuator_force"]["unit"] == "N*m"
    assert look({"time": T, "position": Q, "force": U}).axis == "prismatic"


@pytest.mark.parametrize(
    ("name", "axis"),
    [
        ("torso_lift_joint_position", "prismatic"),
        ("linear encoder", "prismatic"),
        ("slider motor pos", "prismatic"),
        ("arm_1_joint_position", "revolute"),
        ("lift_angle", "revolute"),
    ],
)
def test_a_joint_that_lifts_or_slides_is_no_angle(name, axis):
    survey = look({"time": T, name: Q, "effort": U})
    assert survey.axis == axis
    assert ("part that slides" in survey.guesses["model.device.axis"]) == (axis == "prismatic")


def test_the_state_of_a_controller_of_ros_is_read_by_its_terms():
    rate = np.gradient(Q, T)
    columns = {
        "%time": 1e9 * T, "field.set_point": Q + 0.01, "field.process_value": Q,
        "field.process_value_dot": rate, "field.error": 0.01 + 0.001 * rate, "field.command": U,
        "field.commanded_velocity": 2.0 * U + rate,
        "field.measured_effort": U + 0.2 * np.random.default_rng(1).standard_normal(ROWS),
    }  # fmt: skip
    survey = look(columns)
    assert survey.channels["position"]["column"] == "field.process_value"
    assert "'field.process_value_dot' is the derivative of 'field.process_value'" in survey.notes
    assert survey.channels["actuator_force"]["column"] == "field.command"
    assert survey.axis == "revolute", "there is an effort"


@pytest.mark.parametrize("name", ["theta_dot", "q_dot", "x dot", "pos_dot"])
def test_a_dot_is_a_derivative(name):
    assert likeness(name, "velocity") == 1.0 and likeness(name, "position") == 0.0


@pytest.mark.parametrize(("counts", "expected"), [(4096, 4096), (2000, 2000), (8192, 8192)])
def test_a_velocity_in_units_tells_the_counts_of_a_turn(counts, expected):
    turns = Q * 3.0
    columns = {
        "t": T, "position [inc]": np.round(turns * counts), "velocity [rpm]":
        60.0 * np.gradient(turns, T), "current [mA]": U,
    }  # fmt: skip
    survey = look(columns)
    assert survey.channels["position"]["counts_per_turn"] == pytest.approx(expected, rel=2e-3)
    assert "velocity" in survey.guesses["channels.position.counts_per_turn"]


def strokes(forward, back, seconds=2.0):
    """Places (m) of strokes at two speeds, with round turns."""
    speed = np.where(np.sin(np.pi * T / seconds) > 0, forward, -back)
    smooth = np.convolve(speed, np.ones(21) / 21, "same")
    return np.cumsum(smooth) * 0.005


@pytest.mark.parametrize(
    ("name", "by_speed"), [("p_2", 0.0), ("pressure_bar", 4.0), ("Druck [bar]", 40.0)]
)
def test_a_pressure_that_friction_asks_for_is_no_velocity(name, by_speed):
    """It goes by the direction, or its name says what it is."""
    x = strokes(0.005, 0.011)
    rng = np.random.default_rng(2)
    v = np.gradient(x, T)
    pressure = 5.0 + 0.04 * np.sign(v) + by_speed * v + 0.003 * rng.standard_normal(ROWS)
    columns = {"t_s": T, "x_mm": 1e3 * x, name: pressure, "F_N": 250 + 8 * pressure}
    survey = look(columns)
    assert "velocity" not in survey.channels and survey.channels["position"]["column"] == "x_mm"
    assert not any("derivative" in note for note in survey.notes)
    assert ("a pressure that acts on the body" in survey.unused[name]) == (name != "p_2")
    columns["rate"] = np.gradient(x, T)
    assert look(columns).notes == ["'rate' is the derivative of 'x_mm'"]


def friction_of_strokes(late=0):
    """Force of seal friction and damping in slow strokes, logged so many rows late."""
    x = strokes(0.005, 0.011)
    v = np.gradient(x, T)
    force = 7.0 * np.tanh(v / 2e-4) + 300.0 * v + 250.0
    force += 0.1 * np.random.default_rng(4).standard_normal(ROWS)
    return x, np.r_[np.full(late, force[0]), force[: ROWS - late]]


@pytest.mark.parametrize("late", [0, 4, 8])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_friction_tells_the_sign_where_a_late_force_makes_a_negative_inertia(late, side):
    x, force = friction_of_strokes(late)
    survey = look({"t_s": T, "x_mm": 1e3 * x, "F_N": side * force})
    assert ("channels.position.sign" in survey.guesses) == (side < 0)


def test_a_motion_in_one_direction_tells_no_sign():
    """Chatter about one speed: a constant force is no friction."""
    x = 0.02 * T + 2e-5 * np.sin(2 * np.pi * 3.0 * T)
    for seed in range(20):
        force = 5.0 + 2.0 * np.random.default_rng(seed).standard_normal(ROWS)
        for side in (1.0, -1.0):
            assert not is_turned(side * force, x, 0.005)


@pytest.mark.parametrize(
    "name", ["cicese_gravity", "cicese_presliding", "dm8009", "emps", "hsm150", "mtm_wrist",
             "psm_insertion", "ur10e_joint1"],
)  # fmt: skip
def test_on_real_recordings_the_sign_is_as_it_was_logged(name):
    experiment = load_experiment(shared_folder("data") / name)
    for record in experiment.records:
        signals, rows = record.signals, max(record.segments, key=lambda s: s.stop - s.start)
        position = signals["device.position"][rows]
        forces = ("device.actuator_force", "device.interaction_force")
        force = sum(signals[n][rows] for n in forces if n in signals)
        assert not is_turned(force, position, record.sample_time)
        forth = np.mean(np.diff(position) > 0)
        is_known = explain_force(force, position, record.sample_time).explained > DRIVES
        one_way = not 0.1 < forth < 0.9  # which tells no friction from the weight of a link
        assert is_turned(-force, position, record.sample_time) or not is_known or one_way


@pytest.mark.parametrize("name", ["current_A", "Torque [Nm]", "speed [rad/s]", "F (N)"])
def test_a_column_in_units_of_something_else_is_no_position(name):
    with pytest.raises(ExperimentError, match="found no position"):
        look({"t": T, name: U})


def test_a_coordinate_beside_another_is_no_force():
    columns = {"t": T, "X1": 100 * np.cos(Q), "Y1": np.random.default_rng(1).standard_normal(ROWS)}
    with pytest.raises(ExperimentError, match="found no force: .*--force COLUMN selects one of Y1"):
        look(columns)


@pytest.mark.parametrize("name", ["current", "Motorstrom", "電流", "cur", "iq"])
def test_a_current_by_its_name_is_in_amperes(name):
    survey = look({"t": T, "angle_rad": Q, name: U})
    assert survey.channels["actuator_force"]["unit"] == "A"
    assert "channels.actuator_force.unit" in survey.guesses


@pytest.mark.parametrize(
    "line",
    [
        "encoder: 8192 counts per turn", "# 8192 cnt/rev", "counts_per_turn = 8192", "CPR: 8192",
        "Geber;8192 Inkremente pro Umdrehung", "ticks per revolution: 8192", "8192 cpr",
    ],
)  # fmt: skip
def test_counts_of_a_turn_are_read_above_the_table(line):
    assert counts_per_turn_in(["run 12", line]) == (8192.0, line)
    survey = look({"t": T, "enc": np.round(1000 * Q), "i": U}, (line,))
    assert survey.channels["position"]["counts_per_turn"] == 8192
    assert "a line of the log states" in survey.guesses["channels.position.counts_per_turn"]


@pytest.mark.parametrize(
    "line",
    [
        "motor: kt = 0.105 Nm/A", "k_t: 0,105 N*m/A", "Torque constant (Nm) 0.105 Nm/A",
        "Drehmomentkonstante = 105e-3 Nm/A",
    ],
)  # fmt: skip
def test_a_torque_constant_is_read_above_the_table(line):
    survey = look({"t": T, "angle_rad": Q, "i_A": U}, (line,))
    assert survey.channels["actuator_force"]["torque_constant"]["value"] == 0.105
    assert line in survey.guesses["channels.actuator_force.torque_constant"]


@pytest.mark.parametrize("line", ["kt 3", "skt = 4 Nm/A", "constant of 5", "kt = 2 apples/A", ""])
def test_other_lines_say_no_constant(line):
    assert torque_constant_in([line]) is None and counts_per_turn_in([line]) is None


def test_each_guess_says_what_to_type_where_it_is_wrong():
    survey = look({"column 1": T, "column 2": Q, "cur": U})
    text = survey_text(survey, "log.csv")
    for option in ("--time COLUMN", "--position COLUMN", "--axis revolute",
                   "--unit 'column 2=UNIT'", '--torque-constant "VALUE N/A"'):  # fmt: skip
        assert f"    otherwise: {option}" in text


@pytest.mark.parametrize(
    ("torque", "current"),
    [
        ("target_moment_3", "actual_current_3"),
        ("tau_cmd", "iq"),
        ("Sollmoment", "Motorstrom"),
        ("torque [N*m]", "drive [A]"),
    ],
)
def test_a_motors_constant_is_that_of_a_current(torque, current):
    """Beside a torque the current is taken; a torque alone is not multiplied by it."""
    columns = {"time [s]": T, "q [rad]": Q, torque: U}
    survey = look({**columns, current: U / 9}, torque_constant=(9.0, "N*m/A"))
    force = survey.channels["actuator_force"]
    assert (force["column"], force["unit"]) == (current, "A")
    survey = look(columns, torque_constant=(9.0, "N*m/A"))
    force = survey.channels["actuator_force"]
    assert (force["unit"], force.get("torque_constant")) == ("N*m", None)
    assert "the motor's constant is not used" in survey.guesses["channels.actuator_force.column"]


@pytest.mark.parametrize(
    ("axis", "column", "unit", "words"),
    [
        ("revolute", "t", "kg", "expected one of a time, such as 's'"),
        ("revolute", "q", "kg", "expected one of a position on a revolute axis, such as"),
        ("prismatic", "u", "kg", "expected one of a force on a prismatic axis, such as"),
    ],
)
def test_a_unit_that_does_not_suit_its_column_is_answered_with_one_that_does(
    axis, column, unit, words
):
    with pytest.raises(ExperimentError, match=words):
        look({"t": T, "q": Q, "u": U}, axis=axis, actuator_force="u", units={column: unit})


@pytest.mark.parametrize("gear", [1.0, 20.0])
@pytest.mark.parametrize(
    ("unit", "per_turn"), [("counts", 4096.0), ("deg", 360.0), ("rad", 2 * np.pi)]
)
def test_first_values_are_those_of_the_output_in_any_unit_of_the_motor(unit, per_turn, gear):
    """The joint has 0.02 kg m^2 and 0.3 N m of friction, whatever its motor counts."""
    motor = gear * Q * per_turn / (2 * np.pi)
    choices = {"counts_per_turn": 4096.0} if unit == "counts" else {"units": {"q": unit}}
    survey = look(
        {"t": T, "q": motor, "tau_Nm": U / gear},
        axis="revolute",
        position="q",
        actuator_force="tau_Nm",
        gear_ratio=gear,
        **choices,
    )
    assert survey.first.inertia == pytest.approx(0.02, rel=0.1)
    assert survey.first.level == pytest.approx(0.3, rel=0.1)

"""A log of two sides: no force of the other side, and the sign of a force that is a spring's."""

import numpy as np
import pytest

from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.survey import Choices, survey_log

ROWS = 2000
T = 0.005 * np.arange(ROWS)


def look(columns, **choices):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices(axis="revolute", **choices))


def driven(phase, load=0.0):
    """Angle (rad), motor torque (N m) and outer torque of a joint against a spring `load`."""
    q = np.sin(2 * np.pi * 0.7 * T + phase) + 0.2 * np.sin(2 * np.pi * 2.1 * T)
    rate = np.gradient(q, T)
    outer = -load * q
    return q, 0.02 * np.gradient(rate, T) + 0.3 * np.tanh(rate / 0.05) - outer, outer


@pytest.mark.parametrize(
    "names",
    [
        "/{}/joint_states.position /{}/cmd.torque /{}/ft.tz|master slave",
        "{}Pos {}Torque {}HandForce|master slave",
        "{} pos (deg),{} cmd (Nm),{} FT (Nm)|Leader Follower",
        "q_{} tau_{} ext_{}|m s",
        "q{} u{} hand{}|l r",
        "{}.angle {}.current {}.wrench|local remote",
    ],
)
@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("order", [1, -1])
def test_no_force_of_the_other_side_is_taken(names, side, order):
    """A master's angle went with the slave's torque: "cmd" of the same side is a wish as well."""
    pattern, sides = names.split("|")
    fields, sides = pattern.split("," if "," in pattern else " "), sides.split()
    columns = {"t": T}
    for k, name in list(enumerate(sides))[::order]:
        for field, x in zip(fields, driven(0.05 * k, 0.5 + k), strict=True):
            columns[field.format(name)] = x
    chosen, *forces = (field.format(sides[side]) for field in fields)
    survey = look(columns, position=chosen)
    used = [survey.channels[key]["column"] for key in ("actuator_force", "interaction_force")]
    assert used == forces
    others = [field.format(sides[1 - side]) for field in fields]
    assert all("of another axis" in survey.unused[name] for name in others)


@pytest.mark.parametrize("names", [("pos", "volt_m"), ("temp_s", "i_m"), ("x_m", "u_s")])
def test_a_last_letter_alone_tells_no_side(names):
    position, force = names
    q, u, _ = driven(0.0)
    survey = look({"t": T, position: q, force: u}, position=position)
    assert survey.channels["actuator_force"]["column"] == force


@pytest.mark.parametrize("load", [0.3, 2.0, 30.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_motor_works_against_a_spring_at_its_output(load, sign):
    """The wrong sign leaves no more than the right one: the sum is twice that spring."""
    q, u, outer = driven(0.0, load)
    survey = look({"t": T, "angle": q, "torque": u, "sensor": sign * outer})
    assert survey.channels["interaction_force"].get("sign", 1) == sign
    assert ("channels.interaction_force.sign" in survey.guesses) == (sign < 0)
    assert "sign" not in survey.channels["position"]


@pytest.mark.parametrize("sign", [1, -1])
def test_a_hand_that_moves_a_joint_beside_a_weak_motor_turns_no_position(sign):
    """With the hand's force the wrong way round, friction would drive and inertia be negative."""
    q, needed, _ = driven(0.0)
    weak = 0.05 * np.sin(2 * np.pi * 1.3 * T)
    survey = look({"t": T, "angle": q, "cmd_torque": weak, "hand_torque": sign * (needed - weak)})
    assert survey.channels["interaction_force"].get("sign", 1) == sign
    assert "sign" not in survey.channels["position"]

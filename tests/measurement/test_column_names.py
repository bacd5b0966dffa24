"""Names of columns as people write them: their words, their unit, what they may be."""

import pytest

from teleopdesign.measurement.column_names import (
    bare_name,
    is_another_quantity,
    is_wanted,
    likeness,
    unit_in_name,
    unit_of_text,
    words_of,
)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("Actual_Pos2 (deg)", ["actual", "pos"]),
        ("motorCurrent [mA]", ["motor", "current"]),
        ("joint1.set_point", ["joint", "setpoint"]),
        ("Process Value / °", ["position"]),
        ("theta_dot", ["velocity"]),
        ("x_ddot (m/s^2)", ["acceleration"]),
        ("torque_dot", ["torque", "dot"]),
        ("torAct", ["torque", "act"]),
        ("Trq_Nm", ["torque", "nm"]),
        ("J1.tq", ["j", "torque"]),
        ("torso_angle", ["torso", "angle"]),
        ("0x6064:00 Position actual value", ["position", "actual", "value"]),
        ("Geschwindigkeit_é", ["geschwindigkeit", "e"]),
        ("速度_1", ["速度"]),
        ("42", []),
        ("dot", ["dot"]),
    ],
)
def test_the_words_of_a_name(name, words):
    assert [*words_of(name)] == words


@pytest.mark.parametrize(
    ("name", "bare", "unit"),
    [
        ("Pos (deg)", "Pos", "deg"),
        ("t [ms]", "t", "ms"),
        ("I {A}", "I", "A"),
        ("speed [1/min]", "speed", "rpm"),
        ("angle / rad", "angle", "rad"),
        ("run1 / fit", "run1 / fit", None),
        ("i_A", "i_A", None),  # one letter: only for what may be a current
        ("t_ms", "t_ms", "ms"),
        ("pos_deg", "pos_deg", "deg"),
        ("v_mm_s", "v_mm_s", "mm/s"),
        ("w_rad_per_s", "w_rad_per_s", "rad/s"),
        ("tau_N_m", "tau_N_m", "N*m"),
        ("tau mN_cm", "tau mN_cm", "mN*cm"),
        ("encoder (ticks)", "encoder", "counts"),
        ("load (nm)", "load", "Nm"),
        ("Kraft (foo)", "Kraft", None),
        ("position", "position", None),
    ],
)
def test_the_unit_at_the_end_of_a_name(name, bare, unit):
    assert bare_name(name) == bare
    assert unit_in_name(name) == unit


@pytest.mark.parametrize(
    ("name", "quantity", "axis", "unit"),
    [
        ("i_A", "force", "revolute", "A"),
        ("i_A", "position", "revolute", None),
        ("F_N", "force", "prismatic", "N"),
        ("F_N", "force", "revolute", None),
        ("tau_N_m", "force", "revolute", "N*m"),
        ("tau_N_m", "force", "prismatic", None),
        ("u_V", "force", "prismatic", "V"),
        ("pwm (%)", "force", "prismatic", "%"),
        ("pwm (%)", "position", "prismatic", None),
        ("x_m", "position", "prismatic", "m"),
        ("x_m", "position", "revolute", None),
        ("q (counts)", "position", "revolute", "counts"),
        ("q (counts)", "force", "revolute", None),
        ("v_mm_s", "velocity", "prismatic", "mm/s"),
        ("t_s", "time", "prismatic", "s"),
    ],
)
def test_what_is_no_unit_of_the_quantity_is_a_part_of_the_name(name, quantity, axis, unit):
    assert unit_in_name(name, quantity, axis) == unit


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("degrees", "deg"), ("Amps", "A"), (" ticks ", "counts"), ("counts", "counts"),
        ("nm", "Nm"), ("1/min", "rpm"), ("U/min", "rpm"), ("rad/s", "rad/s"), ("mm", "mm"),
        ("MM", "mm"), ("1", None), ("foo", None), ("12", None),
    ],
)  # fmt: skip
def test_units_as_loggers_write_them(text, unit):
    assert unit_of_text(text) == unit


@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        ("Motor Torque", "actuator_force"),
        ("Drehmoment", "actuator_force"),
        ("Istwinkel", "position"),
        ("joint_position", "position"),
        ("v", "velocity"),
        ("qd", "velocity"),
        ("theta_dot", "velocity"),
        ("f_h", "interaction_force"),
        ("hand force", "interaction_force"),
        ("Zeit", "time"),
        ("timestamp", "time"),
        ("外力传感器", "interaction_force"),
    ],
)
def test_a_name_sounds_most_like_what_it_is(name, quantity):
    scores = {
        q: likeness(name, q)
        for q in ("time", "position", "velocity", "interaction_force", "actuator_force")
    }
    assert max(scores, key=scores.get) == quantity
    assert 0.5 < scores[quantity] <= 1.0


@pytest.mark.parametrize(
    ("name", "wanted", "other"),
    [
        ("target position", True, False),
        ("Sollwinkel", True, False),
        ("targetPosition", True, False),
        ("set_point", True, False),
        ("q_des", True, False),
        ("reference", True, False),
        ("position", False, False),
        ("pressure (bar)", False, True),
        ("motor temp", False, True),
        ("temporary", False, False),
    ],
)
def test_what_was_asked_for_and_what_is_another_quantity(name, wanted, other):
    assert is_wanted(name) == wanted and is_another_quantity(name) == other


@pytest.mark.parametrize(
    "name", ["displacement", "displ_3", "Disp", "stroke", "変位", "Verschiebung"]
)
def test_a_displacement_is_a_position(name):
    assert likeness(name, "position") > 0.7
    assert not any(likeness(name, q) for q in ("velocity", "actuator_force", "interaction_force"))


@pytest.mark.parametrize("name", ["torAct", "ActTrq", "tq_cmd", "torq1"])
def test_a_short_word_for_a_torque_is_one(name):
    assert likeness(name, "actuator_force") == likeness("torque", "actuator_force")

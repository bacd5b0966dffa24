"""Diagrams as data: what a wiring may be, and what is said of one that has no meaning."""

import numpy as np
import pytest
from devices import CANCELLATION, FEEDBACK, LOOP, body

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import CONTROLLERS, controller, scheduled_force_feedback
from teleopdesign.derive import block_symbol, proved_equal, transfer
from teleopdesign.diagrams import (
    ANY,
    Attached,
    Control,
    Diagram,
    Junction,
    Moving,
    haptic_interface,
)
from teleopdesign.diagrams.world_haptics_2005 import READINGS
from teleopdesign.simulate import simulate


def pair(master, slave, coupling):
    """Two bodies joined by a controller on the difference of their positions."""
    return Diagram(
        "pair",
        (
            Moving("M", master, "x_m", "u_m", {"f_u": 1}, "f_u"),
            Moving("S", slave, "x_s", "u_s", {"f_e": 1}, "f_e"),
            Control("P", coupling, "x_e", "f_p", "x_m"),
        ),
        (
            Junction("x_e", {"x_m": 1, "x_s": -1}),
            Junction("u_m", {"f_p": -1}),
            Junction("u_s", {"f_p": 1}),
        ),
        {"f_u": "force", "f_e": "force"},
        measured=("x_m", "x_s"),
    )


def test_two_bodies_and_their_coupling_are_derived_from_the_wiring():
    M, S, P = map(block_symbol, "MSP")
    poles = transfer(pair(ANY, ANY, ANY), "x_s", ("f_u",))["f_u"]
    assert proved_equal(poles, (S + P - P * (M + P) ** -1 * P) ** -1 * P * (M + P) ** -1)


def test_two_bodies_swing_against_each_other():
    """Equal masses on a spring: x_m - x_s swings at sqrt(2 P/m), the middle moves freely."""
    stiff = controller("lead", {"gain": 400.0, "zero": 1.0, "pole": 1.0})
    simulation = simulate(
        pair(body(0.5), body(0.5), stiff),
        duration=0.3,
        initial={"x_m": 1e-3, "x_m_velocity": 0.0},
        computer="continuous",
        jit=False,
    )
    t = simulation["x_m"]["time"].values
    swing = 1e-3 * np.cos(np.sqrt(2 * 400 / 0.5) * t)
    # order four at 1e-4 s and 40 rad/s: 1e-11
    np.testing.assert_allclose(simulation["x_m"] - simulation["x_s"], swing, atol=1e-10)
    np.testing.assert_allclose(simulation["x_m"] + simulation["x_s"], 1e-3, atol=1e-12)
    assert simulation["x_e"].attrs["units"] == "m" and simulation["f_p"].attrs["units"] == "N"


def test_values_are_read_and_changed_by_name():
    diagram = haptic_interface(body(0.2, coulomb__level=0.5), cancellation=CANCELLATION)
    assert diagram.values["C.smoothed_coulomb.level"] == 0.5
    other = diagram.with_values({"Z_M.coulomb.level": 0.7, "C.smoothed_coulomb.level": 0.6})
    assert other.values["Z_M.coulomb.level"] == 0.7
    assert other.values["C.smoothed_coulomb.level"] == 0.6
    assert diagram.values["Z_M.coulomb.level"] == 0.5
    with pytest.raises(ModelError, match='did you mean "Z_M.coulomb.level"'):
        diagram.with_values({"Z_M.coulomb.levl": 1.0})


def test_a_diagram_says_what_it_is():
    text = repr(haptic_interface(hand=ANY, force_feedback=FEEDBACK, position_loop=LOOP))
    for line in ("R_H = -Z_H L", "R_FF = H E", "R_A = R_D + R_FF", "from outside: R_V, L_D"):
        assert line in text


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: controller("smoothed_coulom", {}), 'did you mean "smoothed_coulomb"'),
        (lambda: controller("dahl", {"levl": 1.0}), 'did you mean "level"'),
        (lambda: controller("dahl", {"level": 1.0}), 'parameter "stiffness" has no value'),
        (lambda: controller("low_pass", {"bandwidth": -1.0}), "is outside 0 .. inf"),
        (lambda: haptic_interface(analog=("X",)), 'no controller "X"'),
        (
            lambda: haptic_interface(
                position_loop=controller("spring_damper", {"stiffness": 100.0, "damping": 1.0})
            ),
            "its damper would push along it: expected proportional_derivative",
        ),
        (
            lambda: scheduled_force_feedback(
                gain=1, scheduling_velocity=1, bandwidth=1, schedule="between"
            ),
            '"between"',
        ),
    ],
)
def test_a_controller_without_meaning_is_refused(make, words):
    with pytest.raises(ModelError) as caught:
        make()
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_every_control_law_says_what_it_is_and_where_it_is_from(name):
    law = CONTROLLERS[name]
    assert law.text.strip() and law.source and law.parameters
    assert all(p.meaning for p in law.parameters.values())


@pytest.mark.parametrize("name", READINGS)
def test_a_reading_is_one_of_those_that_fit_and_says_why(name):
    reading = READINGS[name]
    assert reading.value in reading.readings
    assert 0 < reading.confidence <= 1 and reading.why


def test_a_block_taken_out_leaves_no_load_on_a_body_behind():
    held = Diagram(
        "held",
        (Moving("M", ANY, "x", "u", {"f": 1, "f_z": 1}, "f"), Attached("Z", ANY, "x", "f_z")),
        (Junction("u", {}),),
        {"f": "force"},
        measured=("x",),
    )
    assert held.without("Z").block("M").loads == {"f": 1}

"""Diagrams as data: what a wiring may be, and what is said of one that has no meaning."""

import pytest
from devices import CANCELLATION, body

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller, scheduled_force_feedback
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


def test_values_are_read_and_changed_by_name():
    diagram = haptic_interface(body(0.2, coulomb__level=0.5), cancellation=CANCELLATION)
    assert diagram.values["C.smoothed_coulomb.level"] == 0.5
    other = diagram.with_values({"Z_M.coulomb.level": 0.7, "C.smoothed_coulomb.level": 0.6})
    assert other.values["Z_M.coulomb.level"] == 0.7
    assert other.values["C.smoothed_coulomb.level"] == 0.6
    assert diagram.values["Z_M.coulomb.level"] == 0.5
    with pytest.raises(ModelError, match='did you mean "Z_M.coulomb.level"'):
        diagram.with_values({"Z_M.coulomb.levl": 1.0})


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


def test_a_block_taken_out_leaves_no_load_on_a_body_behind():
    held = Diagram(
        "held",
        (Moving("M", ANY, "x", "u", {"f": 1, "f_z": 1}, "f"), Attached("Z", ANY, "x", "f_z")),
        (Junction("u", {}),),
        {"f": "force"},
        measured=("x",),
    )
    assert held.without("Z").block("M").loads == {"f": 1}

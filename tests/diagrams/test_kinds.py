"""Blocks with the names of a kind of diagram in another wiring: derived, written and read."""

import pytest
from devices import body

from teleopdesign.blocks import Body, Value, matrix_impedance
from teleopdesign.cli import main
from teleopdesign.controllers import controller
from teleopdesign.derive import all_transfers
from teleopdesign.diagrams import (
    ANY,
    Attached,
    Control,
    Diagram,
    Junction,
    Linked,
    Moving,
    read_diagram,
    write_diagram,
)
from teleopdesign.diagrams.short_form import kind_of

SPRING = controller("gain", {"gain": 100.0})


def device(name, motion, load, axis="prismatic"):
    moved = Body(axis, {"inertia": Value(0.15)})
    return Moving(name, moved, motion, f"u_{motion}", {load: 1.0}, load)


def with_a_matrix_for_a_hand():
    hand = matrix_impedance(damping=[[3.0]])
    blocks = (device("Z_M", "L", "R_V"), Linked("Z_H", hand, ("L",), ("h",)))
    return Diagram("linked", blocks, (Junction("u_L", {"h": 1.0}),), {"R_V": "force"}, ("L",))


def with_a_lever():
    """A master that turns and a slave that slides, named as those of a teleoperator."""
    blocks = (
        device("Z_m", "X_m", "F_u", axis="revolute"),
        device("Z_s", "X_s", "F_d"),
        Control("P", SPRING, "X_e", "F_P", "X_s"),
    )
    sums = (
        Junction("X_e", {"X_m": 0.05, "X_s": -1.0}),
        Junction("u_X_m", {"F_P": -0.05}),
        Junction("u_X_s", {"F_P": 1.0}),
    )
    outside = {"F_u": "force", "F_d": "force"}
    return Diagram("lever", blocks, sums, outside, ("X_m", "X_s"))


def with_a_hand_that_moves():
    blocks = (
        device("Z_M", "L", "R_V"),
        Moving("Z_H", body(), "h", "u_h", {"f": 1.0}, "f"),
        Control("K", SPRING, "e", "p", "L"),
    )
    sums = (
        Junction("e", {"L": 1.0, "h": -1.0}),
        Junction("u_L", {"p": -1.0}),
        Junction("u_h", {"p": 1.0}),
    )
    return Diagram("held", blocks, sums, {"R_V": "force", "f": "force"}, ("L", "h"))


def without_values():
    """Blocks of the haptic interface of which one is known by its name only."""
    blocks = (device("Z_M", "L", "R_V"), Attached("Z_H", ANY, "L", "h"))
    return Diagram("named", blocks, (Junction("u_L", {"h": 2.0}),), {"R_V": "force"}, ("L",))


WIRINGS = [
    with_a_matrix_for_a_hand,
    with_a_lever,
    with_a_hand_that_moves,
    without_values,
]


@pytest.mark.parametrize("wire", WIRINGS)
def test_names_of_a_kind_may_stand_in_another_wiring(wire, tmp_path):
    diagram, file = wire(), tmp_path / "d.toml"
    assert kind_of(diagram) is None
    assert all_transfers(diagram).transfers
    write_diagram(diagram, file)
    assert read_diagram(file) == diagram
    assert main(["derive", str(file)]) == 0

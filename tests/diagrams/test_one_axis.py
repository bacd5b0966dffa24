"""A radian is no metre: bodies of two axes share no motion, and no sum adds their motions."""

import pytest
import sympy as sp

import teleopdesign as td
from teleopdesign.base.errors import TeleopDesignError
from teleopdesign.diagrams import Diagram, Junction, Kinematics, Moving
from teleopdesign.diagrams.junctions import position_symbol
from teleopdesign.diagrams.parts import Attached

SLIDE = td.Body("prismatic", {"inertia": 0.2})
PADDLE = td.Body("revolute", {"inertia": 1e-3})
HAND = td.hand(mass=0.1, damping=1.0, stiffness=20.0)
COUPLING = td.controller("spring_damper", {"stiffness": 10.0, "damping": 1.0})


def crank(weight=0.05, axis="prismatic"):
    """A paddle, and a hand that holds it at a lever."""
    kinematics = Kinematics("tip", weight * sp.sin(position_symbol("phi")), axis)
    lever = weight * sp.cos(position_symbol("phi"))
    return Diagram(
        "crank",
        (Moving("Z_M", PADDLE, "phi", "u", {"t": 1}, "f"), Attached("Z_H", HAND, "tip", "R_H")),
        (Junction("u", {}), Junction("t", {"R_H": lever, "f": 1})),
        {"f": "force"},
        ("phi",),
        kinematics=(kinematics,),
    )


def test_a_hand_in_metres_holds_no_angle():
    """It was simulated: 20 N/m were 20 N m/rad."""
    with pytest.raises(TeleopDesignError, match="Z_H is prismatic and holds L, which is revolute"):
        td.haptic_interface(PADDLE, hand=HAND)


def test_a_hand_is_held_at_a_lever():
    assert td.simulate_diagram(crank(), duration=2e-3, jit=False)["tip"].attrs["units"] == "m"
    with pytest.raises(TeleopDesignError, match="Z_H is prismatic and holds tip, which is rev"):
        crank(axis="revolute")


def test_two_sides_of_different_axes_are_coupled_by_a_lever_alone():
    """X_m - X_s took radians from metres."""
    with pytest.raises(TeleopDesignError, match="X_e adds angles to lengths.*X_s is revolute"):
        td.teleoperator(SLIDE, PADDLE, coupling=COUPLING)
    whole = td.teleoperator(SLIDE, SLIDE, coupling=COUPLING)
    terms = {"X_m": 1, "X_s": -0.05}
    levers = tuple(Junction("X_e", terms) if j.output == "X_e" else j for j in whole.junctions)
    blocks = tuple(
        Moving(b.name, PADDLE, b.motion, b.command, b.loads, b.driver) if b.name == "Z_s" else b
        for b in whole.blocks
    )
    made = Diagram("mixed", blocks, levers, whole.outside, whole.measured)
    assert td.simulate_diagram(made, duration=2e-3, jit=False, inputs={"F_u": 1.0})["X_m"][-1] > 0

"""Every signal of a simulation carries the SI unit of its quantity on its axis."""

from dataclasses import replace

import control
import pytest
from devices import CANCELLATION, FEEDBACK, LUGRE, body

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, haptic_interface
from teleopdesign.simulate import simulate, sine
from teleopdesign.simulate.units import signal_units


def on(axis):
    device = replace(body(**LUGRE), axis=axis)
    return haptic_interface(device, cancellation=CANCELLATION, force_feedback=FEEDBACK)


@pytest.mark.parametrize(
    ("axis", "force", "position"), [("prismatic", "N", "m"), ("revolute", "N*m", "rad")]
)
def test_signals_have_the_units_of_their_axis(axis, force, position):
    unit = signal_units(on(axis))
    assert {unit(n) for n in ("R_M", "R_MBC", "Z_M_friction")} == {force}
    assert unit("L") == position
    assert unit("L_velocity") == f"{position}/s"
    assert unit("L_acceleration") == f"{position}/s^2"
    assert unit("Z_M_presliding_bristle") == position  # a hidden state has its quantity's unit


def test_a_simulation_writes_these_units_beside_its_signals():
    diagram = on("prismatic")
    motion = {"L": sine(amplitude=1e-3, frequency=5.0)}
    simulation = simulate(diagram, duration=0.01, motion=motion, jit=False)
    unit = signal_units(diagram)
    assert len(simulation.data) > 5
    for name, signal in simulation.data.items():
        assert signal.attrs["units"] == unit(name)


def follower(*controls, junctions=()):
    """A body that a hand pushes and a controller drives; `r` is a position from outside."""
    rod = Moving("Z", body(0.1), "x", "u", {"f": 1.0}, "f")
    outside = {"r": "position", "f": "force"}
    return Diagram("follower", (rod, *controls), junctions, outside, ("x", "r"))


LAG = from_control(control.tf([1.0], [0.1, 1.0]), name="lag")
SPRING = controller("lead", {"gain": 2e3, "zero": 1.0, "pole": 10.0})


def test_a_controller_whose_output_is_a_position_is_not_labelled_as_a_force():
    """A filtered reference that is compared with a motion, and one in a row of controllers."""
    compared = follower(
        Control("F", LAG, "r", "r_filtered", "x"),
        Control("K", SPRING, "e", "u", "x"),
        junctions=(Junction("e", {"r_filtered": 1.0, "x": -1.0}),),
    )
    unit = signal_units(compared)
    assert [unit(n) for n in ("r_filtered", "e", "x", "u", "f")] == ["m", "m", "m", "N", "N"]
    in_a_row = follower(
        Control("F", LAG, "x", "x_filtered", "x"), Control("K", SPRING, "x_filtered", "u", "x")
    )
    unit = signal_units(in_a_row)
    assert [unit(n) for n in ("x_filtered", "u")] == ["m", "N"]

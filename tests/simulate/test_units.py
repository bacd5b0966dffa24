"""Every signal of a simulation carries the SI unit of its quantity on its axis."""

from dataclasses import replace

import pytest
from devices import CANCELLATION, FEEDBACK, LUGRE, body

from teleopdesign.diagrams import haptic_interface
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
    simulation = simulate(diagram, duration=0.01, motion={"L": sine(amplitude=1e-3, frequency=5.0)})
    unit = signal_units(diagram)
    assert len(simulation.data) > 5
    for name, signal in simulation.data.items():
        assert signal.attrs["units"] == unit(name)

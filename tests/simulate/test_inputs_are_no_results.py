"""A signal that was given to a simulation is none of its results, and the error says so."""

import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import observe_simulation

DEVICE = td.haptic_interface(body(0.1, viscous__damping=1.0))


def test_an_input_that_is_asked_for_is_named_as_such():
    pushed = td.simulate_diagram(DEVICE, duration=0.01, inputs={"R_V": 1.0}, jit=False)
    with pytest.raises(ModelError, match='"R_V" comes from outside, as it was given in `inputs`'):
        pushed["R_V"]
    with pytest.raises(ModelError, match='"R_V" comes from outside'):
        observe_simulation(pushed)
    with pytest.raises(ModelError, match='no signal "R_Q"'):
        pushed["R_Q"]


def test_the_force_of_a_prescribed_motion_is_a_result():
    led = td.simulate_diagram(
        DEVICE, duration=0.01, motion={"L": td.sine(amplitude=1e-3, frequency=5.0)}, jit=False
    )
    assert "R_V" in led and led["R_V"].size

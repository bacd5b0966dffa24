"""Virtual admittance: the motion of a virtual mass, damper and spring under the input force.

    M d^2x/dt^2 + B dx/dt + K x = input,   output = x

The input is a measured force. A position loop makes a device follow the output. In a computer the
step is exact for a force that is held over each sample.
"""

from ..effects import Parameter
from . import _state_space
from ._controller import ControlLaw, Controller, ControllerState

#: kg or kg m^2: least mass, which must not be zero; a millionth of a mass that a hand can feel
_LIGHTEST = 1e-6


def law(now, p):
    return now.position


def position(now, p):
    return now.velocity


def velocity(now, p):
    return (now.input - p.damping * now.velocity - p.stiffness * now.position) / p.inertia


def discretise(values, period):
    below = [values[name] for name in ("inertia", "damping", "stiffness")]
    continuous = _state_space.rational_stage("virtual_admittance", [1.0], below, None)
    return Controller((continuous,)).sampled(period).stages[0]


CONTROLLER = ControlLaw(
    law=law,
    states={
        "position": ControllerState("position", position),
        "velocity": ControllerState("velocity", velocity),
    },
    linear=True,
    sampled=discretise,
    parameters={
        "inertia": Parameter("inertia", "M: virtual inertia", lower=_LIGHTEST),
        "damping": Parameter("damping", "B: virtual damping"),
        "stiffness": Parameter("stiffness", "K: virtual stiffness"),
    },
    source="admittance control in the sense of Hogan, J. Dyn. Syst. Meas. Control 107 (1985) 1",
)

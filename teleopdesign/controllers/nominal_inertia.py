"""Nominal inertia: the force that a modelled body takes along the measured motion, low-passed.

    F = Q (M_n dv/dt + B_n v),   Q = 2 pi f_c/(s + 2 pi f_c)

Less the low-passed command, Q u, it is what else acts on the body: a disturbance observer, whose
two halves `disturbance_observer` wires. The velocity v is that of the motion it acts along.
"""

from types import SimpleNamespace

from ..effects import Parameter
from . import low_pass
from ._controller import ControlLaw, ControllerState


def change(now, p):
    return low_pass.output(SimpleNamespace(input=now.velocity, output=now.filtered), p)


def law(now, p):
    return p.inertia * change(now, p) + p.damping * now.filtered


CONTROLLER = ControlLaw(
    law=law,
    states={"filtered": ControllerState("velocity", change)},
    linear=True,
    parameters={
        "inertia": Parameter("inertia", "M_n: nominal inertia"),
        "damping": Parameter("damping", "B_n: nominal damping"),
        "bandwidth": Parameter("frequency", "f_c: cut-off of Q in Hz"),
    },
    source="Ohnishi, Shibata, Murakami, IEEE/ASME Trans. Mechatronics 1 (1996) 56",
)

"""Nominal inertia: the force of a modelled body along the measured motion, low-passed.

    F = Q (M_n dv/dt + B_n v),   Q = 2 pi f_c/(s + 2 pi f_c)

F less the low-passed command Q u is the sum of all other forces on the body. This difference is a
disturbance observer; `disturbance_observer` connects the two halves. v is the velocity of the
motion along which the law acts.
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

"""Spring and damper by a computer or circuit: joins two sides of a teleoperator.

    F = k e + d v

The input is e. v is the velocity of the motion along which the block is connected: de/dt where that
motion is e itself. If e is the difference of two positions, the law is position-position control.
If e is the position of the interface, the law is a virtual wall that is not one-sided. With an
input that is late or filtered the damper still acts along the motion without delay;
`proportional_derivative` differentiates the input itself.
"""

from ..effects import Parameter
from ._controller import ControlLaw


def law(now, p):
    return p.stiffness * now.input + p.damping * now.velocity


CONTROLLER = ControlLaw(
    law=law,
    linear=True,
    parameters={
        "stiffness": Parameter("stiffness", "k: force per position", lower=-float("inf")),
        "damping": Parameter("damping", "d: force per velocity", lower=-float("inf")),
    },
    source="Mahvash, Okamura, ICRA 2006, eq (10), with a damper beside the spring",
)

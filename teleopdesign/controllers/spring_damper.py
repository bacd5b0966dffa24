"""Spring and damper that a computer or circuit makes: joins two sides of a teleoperator.

    F = k e + d v

Input is e, and v the velocity of the motion that the block is wired along, de/dt where that motion
is e itself. With e the difference of two positions this is position-position control; of the
interface's position, a virtual wall without its side. On a signal that is late or filtered the
damper still acts along the motion, now; `proportional_derivative` differentiates what it reads.
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

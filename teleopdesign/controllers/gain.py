"""Gain: the output is a multiple of the input, of whatever kind that is.

    output = k input

A gain scales a channel (position or force of the other side), or feeds a force forward.
"""

from ..effects import Parameter
from ._controller import ControlLaw


def law(now, p):
    return p.gain * now.input


CONTROLLER = ControlLaw(
    law=law,
    linear=True,
    parameters={
        "gain": Parameter("dimensionless", "k: output for an input of 1", lower=-float("inf"))
    },
    source="scaling of Lawrence, IEEE Trans. Robotics Autom. 9 (1993) 624",
)

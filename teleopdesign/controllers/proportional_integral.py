"""Proportional and integral: a multiple of the input, and what has come in so far.

    output = k (input + r w),   dw/dt = input

From an error of velocity it makes a damper k and a spring k r; from an error of force, the force
that leaves no error at rest.
"""

from ..effects import Parameter
from ._controller import ControlLaw, ControllerState


def law(now, p):
    return p.gain * (now.input + p.rate * now.integral)


def integral(now, p):
    return now.input


CONTROLLER = ControlLaw(
    law=law,
    states={"integral": ControllerState("force", integral)},
    linear=True,
    parameters={
        "gain": Parameter("dimensionless", "k: output for an input of 1", lower=-float("inf")),
        "rate": Parameter("frequency", "r: 1/s; the integral is as large as the input after 1/r"),
    },
    source="proportional and integral control in the sense of any control text",
)

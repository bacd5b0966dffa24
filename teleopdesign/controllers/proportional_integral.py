"""Proportional and integral: a multiple of the input, and of the integral of the input.

    output = k (input + r w),   dw/dt = input

From an error of velocity the law makes a damper k and a spring k r. From an error of force the law
makes a force that leaves no error at rest.
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

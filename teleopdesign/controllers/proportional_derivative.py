"""Proportional and derivative: a spring and a damper on the input.

    F = k e + d dw/dt,   dw/dt = 2 pi f_c (e - w)

The derivative is that of the low-passed input, so the law is proper. In the sampled law the
derivative is the mean over the coming sample. This mean is exact for a ramp. The derivative at the
sample itself, with the input held, is too large by half of 2 pi f_c T.
"""

from types import SimpleNamespace

from sympy import diff, exp

from ..effects import Parameter
from . import low_pass
from ._controller import ControlLaw, ControllerState


def filtered(now, p):
    return low_pass.output(SimpleNamespace(input=now.input, output=now.filtered), p)


def derivative(now, p):
    rate = filtered(now, p)
    if now.period == 0:
        return rate
    decay = -diff(rate, now.filtered) * now.period
    return rate * (1 - exp(-decay)) / decay


def law(now, p):
    return p.stiffness * now.input + p.damping * derivative(now, p)


CONTROLLER = ControlLaw(
    law=law,
    states={"filtered": ControllerState("position", filtered)},
    linear=True,
    parameters={
        "stiffness": Parameter("stiffness", "k: force per input"),
        "damping": Parameter("damping", "d: force per rate of the input"),
        "bandwidth": Parameter("frequency", "f_c: -3 dB frequency of the derivative in Hz"),
    },
    source="spring and damper, as in position-position coupling",
)

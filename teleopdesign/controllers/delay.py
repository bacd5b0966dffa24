"""Dead time: the output is the input of a fixed time earlier, zero before the start.

    output(t) = input(t - T),   e^(-s T)

A channel between two sides, or the way to a far sensor. In a computer it is a buffer of samples: a
whole number of them is exact, and between two samples the output lies on the line that joins them.
As an analog block it acts in continuous time.
"""

from sympy import exp

from ..effects import Parameter, delayed
from ._controller import ControlLaw
from ._exact import exact_decimal


def law(now, p):
    return delayed(now.input, p.time)


def transfer(values, s):
    return exp(-exact_decimal(values["time"]) * s)


CONTROLLER = ControlLaw(
    law=law,
    transfer=transfer,
    linear=True,
    parameters={"time": Parameter("time", "T: from input to output; 0: none")},
    dead_time="time",
    source="dead time in the sense of any control text",
)

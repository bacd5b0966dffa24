"""Dead time: the output is the input of a fixed time earlier, zero before the start.

    output(t) = input(t - T),   e^(-s T)

Examples are a channel between two sides, and the path to a distant sensor. In a computer the dead
time is a buffer of samples. A whole number of samples is exact; between two samples the output is
interpolated linearly. An analog block acts in continuous time.
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
    parameters={"time": Parameter("time", "T: time from input to output; 0: none")},
    dead_time="time",
    source="dead time in the sense of any control text",
)

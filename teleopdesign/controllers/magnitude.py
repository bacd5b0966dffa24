"""Magnitude: the size of the input without its sign.

    output = k abs(input)

Two magnitudes limit one signal by another: (abs(f + l) - abs(f - l))/2 is f within -l ... l.
"""

from sympy import Abs

from ..effects import Parameter
from ._controller import ControlLaw


def law(now, p):
    return p.gain * Abs(now.input)


CONTROLLER = ControlLaw(
    law=law,
    parameters={
        "gain": Parameter("dimensionless", "k: output for an input of 1", lower=-float("inf"))
    },
    source="arithmetic",
)

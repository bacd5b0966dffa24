"""Gain: the output is a constant factor times what the law says.

    y = g y_law

A wrong amplifier constant, a factor forgotten in the code. Where one block alone makes the command,
a gain of the block and one of the computer are the same.
"""

import numpy as np

from ..._parameter import Parameter
from ._control_effect import ControlEffect


def act(samples, value, period):
    return value * samples


def starts(samples, period):
    return np.array([0.7, 1.3])


EFFECT = ControlEffect(
    act=act,
    parameter="gain",
    declared=Parameter("dimensionless", "g: factor of the output", lower=-float("inf")),
    starts=starts,
    absent=1.0,
)

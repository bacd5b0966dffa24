"""Bias: a constant that is added to the output.

    y = y_law + b

An offset of a converter, a gravity term left in. All blocks whose outputs are summed have the same
bias at the sum: only a recording of their own outputs tells them apart.
"""

import numpy as np

from ..._parameter import Parameter
from ._control_effect import ControlEffect


def act(samples, value, period):
    return samples + value


def starts(samples, period):
    return np.array([0.0])


EFFECT = ControlEffect(
    act=act,
    parameter="force",
    declared=Parameter("force", "b: constant added to the output", lower=-float("inf")),
    starts=starts,
)

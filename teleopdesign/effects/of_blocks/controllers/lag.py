"""Lag: the output follows the law through a first-order low-pass.

    y = w,   tau dw/dt = y_law - w

In the computer the output is read before the update of the sample, so that the least lag is a delay
of one sample.
"""

import math

import numpy as np

from ..._parameter import Parameter
from ._control_effect import ControlEffect, times


def act(samples, value, period):
    from scipy.signal import lfilter

    kept = math.exp(-period / value) if value > 0 else 0.0
    return np.asarray(lfilter([0.0, 1.0 - kept], [1.0, -kept], samples))


EFFECT = ControlEffect(
    act=act,
    parameter="time_constant",
    declared=Parameter("time", "tau: time constant of the low-pass"),
    starts=times,
)

"""Velocity filter: the velocity that the law uses comes through a low-pass that is not stated.

    tau dv_f/dt = v - v_f,   v the difference of two readings over the period

The step is that of the simulation's computer: the filter is updated first and read then.
"""

import math

import numpy as np

from ..._parameter import Parameter
from ._control_effect import ControlEffect, times


def act(samples, value, period):
    from scipy.signal import lfilter

    kept = math.exp(-period / value) if value > 0 else 0.0
    return np.asarray(lfilter([1.0 - kept], [1.0, -kept], samples))


EFFECT = ControlEffect(
    act=act,
    parameter="time_constant",
    declared=Parameter("time", "tau: time constant of the low-pass"),
    starts=times,
    on_velocity=True,
)

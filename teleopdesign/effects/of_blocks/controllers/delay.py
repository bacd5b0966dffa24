"""Delay: the output comes a fixed time later.

    y(t) = y_law(t - T)

A buffer of samples, zero before its first one; between two samples the output is interpolated
linearly, as in the control law `delay`.
"""

import numpy as np

from ..._parameter import Parameter
from ._control_effect import ControlEffect


def act(samples, value, period):
    rows = np.arange(len(samples), dtype=float)
    return np.interp(rows - value / period, rows, samples, left=0.0)


def starts(samples, period):
    return period * np.unique(np.round(np.geomspace(1.0, max(0.1 / period, 4.0), 14)))


EFFECT = ControlEffect(
    act=act,
    parameter="delay",
    declared=Parameter("time", "T: time from the law to the output"),
    starts=starts,
)

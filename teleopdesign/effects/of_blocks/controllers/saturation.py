"""Saturation: the output is limited.

    y = min(max(y_law, -F_max), F_max)

Rows at the limit are blind: what the law says there has no influence.
"""

import numpy as np

from ..._parameter import Parameter
from ._control_effect import ControlEffect, amplitudes


def act(samples, value, period):
    return np.clip(samples, -value, value)


def passes(samples, value):
    return np.abs(samples) < value


EFFECT = ControlEffect(
    act=act,
    parameter="limit",
    declared=Parameter("force", "F_max: largest output"),
    starts=amplitudes,
    passes=passes,
    absent=float("inf"),
)

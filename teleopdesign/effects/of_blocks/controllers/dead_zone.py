"""Dead zone: a small output of the law has no effect.

    y = sgn(y_law) max(abs(y_law) - w, 0)

Rows within the zone are blind.
"""

import numpy as np

from ..._parameter import Parameter
from ._control_effect import ControlEffect, amplitudes


def act(samples, value, period):
    return np.sign(samples) * np.maximum(np.abs(samples) - value, 0.0)


def passes(samples, value):
    return np.abs(samples) > value


EFFECT = ControlEffect(
    act=act,
    parameter="half_width",
    declared=Parameter("force", "w: largest output of the law that is lost"),
    starts=amplitudes,
    passes=passes,
)

"""The usual step between the stamps of a clock, and what steps far from it are."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .encoder import Array
from .limits import HALF

#: most successive lost rows that are filled, and most rows by which one is out of order: more are a
#: pause, or a clock that was set back. At 1 kHz six sample times are a tenth of a period at 16 Hz,
#: so the motion between them is still known in the band of a comparison
GOES_ON = 5


def usual_step(steps: Array) -> float:
    """The usual one of the steps between stamps, s: the mean of those near the median.

    steps: those of 0 and back do not count; 0 where none is left
    """
    forward = steps[steps > 0]
    if not len(forward):
        return 0.0
    usual = float(np.median(forward))
    near = forward[np.abs(forward - usual) < HALF * usual]
    return float(near.mean()) if len(near) else usual


def step_deviations(stamps: Array) -> Array:
    """Distance of each step between stamps (n,) from the usual one, in usual steps, (n - 1,)."""
    steps = np.diff(stamps)
    usual = usual_step(steps)
    return np.abs(steps / usual - 1.0) if usual > 0 else np.full(len(steps), math.inf)


def are_set_back(steps: Array, usual: float) -> NDArray[np.bool_]:
    """Steps between stamps (n,) at which a clock was set back: further than a row out of order."""
    return np.asarray(steps < -(GOES_ON + 0.5) * usual)


def are_out_of_order(stamps: Array) -> bool:
    """Whether stamps are those of one clock, each once, with rows a little out of order."""
    steps, ordered = np.diff(stamps), np.diff(np.sort(stamps))
    if not np.any(steps < 0) or not np.all(ordered > 0):
        return False
    return not are_set_back(steps, usual_step(ordered)).any()

"""Onset of instability: whether a swing grows, and the least of a parameter at which it does."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..errors import GrowsWithoutBound
from ..simulate import Simulation


def growth(simulated: Callable[[], Simulation], signal: str) -> float:
    """rms in the last third of the simulation over that in the middle third, less 1.

    0 where the signal is zero in both; infinite where signals grow beyond all bounds
    """
    try:
        values = simulated()[signal].values
    except GrowsWithoutBound:
        return math.inf
    _, middle, last = (float(np.square(part).mean()) for part in np.array_split(values, 3))
    if middle == 0:
        return math.inf if last > 0 else 0.0
    return math.sqrt(last / middle) - 1


def least_that_grows(
    grows: Callable[[float], bool], *, within: tuple[float, float], steps: int
) -> float:
    """By bisection of the logarithm, to the upper end; NaN where it is not within.

    within: > 0;  steps: halvings: the result is within (high/low)^(2^-steps) of the onset
    """
    low, high = within
    if not grows(high) or grows(low):
        return float("nan")
    for _ in range(steps):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if grows(middle) else (middle, high)
    return high

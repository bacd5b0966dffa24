"""Onset of instability: whether an oscillation grows, and the parameter at which that begins."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..base.errors import GrowsWithoutBound
from ..simulate import Simulation

#: a swing has died out if it is below this share of the largest one: smaller swings are creep of
#: bristles and rounding, and their ratios have no meaning
DIED_OUT = 1e-3


def growth(simulated: Callable[[], Simulation], signal: str) -> float:
    """Range of the signal in the last third of the simulation over the middle third, less 1.

    -1: the oscillation has died out;  inf: signals grow without bound
    """
    return growth_of(lambda: np.asarray(simulated()[signal].values))


def growth_of(samples: Callable[[], np.ndarray]) -> float:
    """As `growth`, from the samples of a signal, (rows,)."""
    try:
        values = samples()
    except GrowsWithoutBound:
        return math.inf
    middle, last = (float(np.ptp(part)) for part in np.array_split(values, 3)[1:])
    if last <= DIED_OUT * np.ptp(values):
        return -1.0
    return last / middle - 1 if middle > 0 else math.inf


def find_onset(grows: Callable[[float], bool], *, within: tuple[float, float], steps: int) -> float:
    """A value at which growth begins; NaN if a simulation grows at low already, or not at high.

    It is the smallest one only where every larger value grows too: bisection sees no island of
    growth below it.
    grows: whether the simulation with a value grows;  within: lowest and highest value, > 0
    steps: halvings of the logarithm: the result is within (high/low)^(2^-steps) of the onset
    """
    low, high = within
    if not grows(high) or grows(low):
        return float("nan")
    for _ in range(steps):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if grows(middle) else (middle, high)
    return high

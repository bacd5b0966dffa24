"""What studies of onset share: the least of a parameter at which something grows."""

from __future__ import annotations

import math
from collections.abc import Callable


def least_that_grows(
    grows: Callable[[float], bool], *, within: tuple[float, float], steps: int
) -> float:
    """By bisection of the logarithm, to the upper end; NaN where it is not within."""
    low, high = within
    if not grows(high) or grows(low):
        return float("nan")
    for _ in range(steps):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if grows(middle) else (middle, high)
    return high

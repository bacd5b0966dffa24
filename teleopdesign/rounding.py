"""Numbers with few digits, rounded to the side on which a condition still holds."""

from __future__ import annotations

import math


def _scale(value: float, digits: int) -> float:
    return 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)


def round_down(value: float, *, digits: int = 3) -> float:
    """The largest number of so many digits that is not above a value; 0 and infinity stay."""
    if value == 0 or not math.isfinite(value):
        return value
    step = _scale(value, digits)
    # a part in 1e9: a number that has few digits already stays what it is
    return float(f"{math.floor(value / step * (1 + math.copysign(1e-9, value))) * step:.{digits}g}")


def round_up(value: float, *, digits: int = 3) -> float:
    """The smallest number of so many digits that is not below a value; 0 and infinity stay."""
    if value == 0 or not math.isfinite(value):
        return value
    step = _scale(value, digits)
    return float(f"{math.ceil(value / step * (1 - math.copysign(1e-9, value))) * step:.{digits}g}")


def round_near(value: float, *, digits: int = 3) -> float:
    """The nearest number of so many digits."""
    return float(f"{value:.{digits}g}")

"""Numbers with few digits, rounded to the side on which a condition still holds; durations."""

from __future__ import annotations

import math
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal


def _round_to(value: float, digits: int, side: str) -> float:
    """The value rounded in its decimal form; a number with few digits stays unchanged."""
    if value == 0 or not math.isfinite(value):
        return value
    exact = Decimal(repr(float(value)))
    step = Decimal(1).scaleb(exact.adjusted() - digits + 1)
    return float((exact / step).to_integral_value(rounding=side) * step)


def round_down(value: float, *, digits: int = 3) -> float:
    """The largest number with `digits` digits that is not above the value; 0 and infinity stay."""
    return _round_to(value, digits, ROUND_FLOOR)


def round_up(value: float, *, digits: int = 3) -> float:
    """The smallest number with `digits` digits that is not below the value; 0 and infinity stay."""
    return _round_to(value, digits, ROUND_CEILING)


def round_near(value: float, *, digits: int = 3) -> float:
    """The number with `digits` significant digits that is nearest to the value."""
    return float(f"{value:.{digits}g}")


def duration_text(seconds: float) -> str:
    """A duration (s) with few digits in a suitable unit: "42 s", "7 min", "3.5 h", "12 days"."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 90 * 60:
        return f"{seconds / 60:.0f} min"
    hours = seconds / 3600
    return f"{hours:.3g} h" if hours < 48 else f"{hours / 24:.3g} days"

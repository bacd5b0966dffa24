"""Numbers and durations as sentences and tables contain them."""

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


def with_standard_error(value: float, error: float) -> str:
    """A value and its standard error: 0.0244 +- 0.0009, 110 +- 15, 2.63e+05 +- 3.1e+03.

    The error has two significant digits, and the value ends at the same decimal. A value whose
    error is unknown (NaN, infinite, 0) stands without an error, with five digits.
    """
    if not (math.isfinite(error) and error > 0.0 and math.isfinite(value)):
        return f"{value:.5g}"
    rounded = f"{error:.1e}"
    last = 1 - int(rounded.partition("e")[2])  # decimals up to the error's second digit
    if 0 <= last <= 6 and max(abs(value), error) < 1e5:
        return f"{value:.{last}f} +- {error:.{last}f}"
    if value == 0.0:
        return f"0 +- {error:.2g}"
    digits = math.floor(math.log10(abs(value))) + last + 1
    return f"{value:.{min(max(digits, 2), 7) - 1}e} +- {error:.1e}"

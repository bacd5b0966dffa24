"""An estimate and its standard error as a terminal prints them."""

from __future__ import annotations

import math


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

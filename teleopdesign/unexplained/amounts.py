"""Numbers with units in a readable form: "4 mm/s", "0.3 N", "12 %"."""

from __future__ import annotations

import math

from ..base.units import unit_after_number, unit_of

#: quantities that are written in thousandths of their unit up to one unit
_LENGTHS = ("position", "velocity")


def unit_for(quantity: str, axis: str, largest: float) -> tuple[float, str]:
    """Factor from SI, and the unit in which a quantity up to `largest` reads well."""
    unit = unit_of(quantity, axis)
    if quantity == "dimensionless":
        return 100.0, "%"
    if unit == "kg":
        return (1e3, "g") if abs(largest) < 0.1 else (1.0, unit)
    shown = unit.replace("*", " ")
    limit = 1.0 if quantity in _LENGTHS and axis == "prismatic" else 0.1
    prefixed = quantity in ("position", "velocity", "force", "time")
    return (1e3, f"m{shown}") if prefixed and abs(largest) < limit else (1.0, shown)


def number(value: float) -> str:
    """A number with two significant digits, without an exponent where possible."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    digits = max(0, 1 - math.floor(math.log10(abs(float(f"{value:.1e}")))))
    return (
        f"{value:.2g}" if abs(value) >= 1e5 or digits > 4 else f"{float(f'{value:.2g}'):.{digits}f}"
    )


def amount(value: float, quantity: str, axis: str) -> str:
    """A value (SI) with its unit, in a readable form."""
    factor, unit = unit_for(quantity, axis, value)
    return f"{number(factor * value)}{unit_after_number(unit)}"


def describe_span(low: float, high: float, quantity: str, axis: str) -> str:
    """Two values (SI) with one unit: "4 and 20 mm/s"."""
    factor, unit = unit_for(quantity, axis, max(abs(low), abs(high)))
    return f"{number(factor * low)} and {number(factor * high)}{unit_after_number(unit)}"

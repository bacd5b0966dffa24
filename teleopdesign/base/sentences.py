"""Numbers, units, durations and lists of names, as texts, tables and labels contain them.

A terminal shows "0.0244 +- 0.0009 N*m", a sentence "24 mN m", a page "0.0244 ± 0.0009 N·m" and
"1.2·10⁻⁶", an axis a unit with thin spaces. Numbers of a condition are rounded to the side on which
the condition still holds.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

from .units import unit_after_number, unit_of

MINUS = "\u2212"
#: in place of a number on a page
NONE = "–"
_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
#: the sign between two units, and an exponent after a unit
_PRODUCT = re.compile(r"(?<=[A-Za-z])\*(?=[A-Za-z])")
_POWER = re.compile(r"(?<=[a-z])\^([23])(?!\d)")


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


def number(value: float) -> str:
    """A number with two significant digits, without an exponent where possible: 4.0, 120."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    digits = max(0, 1 - math.floor(math.log10(abs(float(f"{value:.1e}")))))
    if abs(value) >= 1e5 or digits > 4:
        return f"{value:.2g}"
    return f"{float(f'{value:.2g}'):.{digits}f}"


def number_on_page(value: float | None, digits: int = 4) -> str:
    """A number with some significant digits: 0.1972, −12 300, 1.2·10⁻⁶; a dash for None or NaN."""
    if value is None or not math.isfinite(value):
        return NONE
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    if -4 < exponent < 5:
        text = f"{value:.{max(digits - 1 - exponent, 0)}f}"
    else:
        text = f"{value / 10.0**exponent:.{digits - 1}f}·10{str(exponent).translate(_SUPERSCRIPT)}"
    return text.replace("-", MINUS)


def short_on_page(value: float | None, digits: int = 4) -> str:
    """A number on a page without trailing zeros: 60, 58.9, 7.2·10⁻⁶."""
    text, times, power = number_on_page(value, digits).partition("·")
    return (text.rstrip("0").rstrip(".") if "." in text else text) + times + power


def with_standard_error(value: float, error: float) -> str:
    """A value and its standard error: 0.0244 +- 0.0009, 110 +- 15, 2.63e+05 +- 3.1e+03.

    The error has two significant digits, and the value ends at the same decimal. A value whose
    error is unknown (NaN, infinite, 0) stands without an error, with five digits.
    """
    if not (math.isfinite(error) and error > 0.0 and math.isfinite(value)):
        return f"{value:.5g}"
    last = _decimals(error)
    if 0 <= last <= 6 and max(abs(value), error) < 1e5:
        return f"{value:.{last}f} +- {error:.{last}f}"
    if value == 0.0:
        return f"0 +- {error:.2g}"
    return f"{value:.{_digits(value, last) - 1}e} +- {error:.1e}"


def with_error_on_page(value: float, error: float | None) -> tuple[str, str]:
    """A value and its standard error for two columns of a page; a dash for an unknown error."""
    if error is None or not math.isfinite(error) or error <= 0:
        return number_on_page(value), NONE
    last = _decimals(error)
    if 0 <= last <= 6 and abs(value) < 1e5:
        return f"{value:.{last}f}".replace("-", MINUS), f"{error:.{last}f}"
    if value == 0:
        return "0", number_on_page(error, 2)
    return number_on_page(value, _digits(value, last)), number_on_page(error, 2)


def _decimals(error: float) -> int:
    """Decimals up to the second digit of an error; below 0: digits before the decimal point."""
    return 1 - int(f"{error:.1e}".partition("e")[2])


def _digits(value: float, decimals: int) -> int:
    """Significant digits of a value up to a decimal, 2 to 7."""
    return min(max(math.floor(math.log10(abs(value))) + decimals + 1, 2), 7)


def percent(part: float | None, form: str = ".2f", *, unknown: str = "unknown") -> str:
    """A part of a whole as "7.07 %", also 1 with two digits: "100 %".

    form: format of the number;  unknown: text in place of a number that is None or not finite
    """
    if part is None or not math.isfinite(part):
        return unknown
    text = f"{100 * part:{form}}"
    return f"{float(text):.0f} %" if "e+" in text else f"{text} %"


def percent_on_page(part: float | None) -> str:
    """A part of a whole as 7.07 % with a narrow space; a dash for None or NaN."""
    return percent(part, unknown=NONE).replace(" %", "\u202f%")


def duration_text(seconds: float) -> str:
    """A duration (s) with few digits in a suitable unit: "42 s", "7 min", "3.5 h", "12 days"."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 90 * 60:
        return f"{seconds / 60:.0f} min"
    hours = seconds / 3600
    return f"{hours:.3g} h" if hours < 48 else f"{hours / 24:.3g} days"


#: columns of a line of text
WIDTH = 100


def wrap(text: str, *, first: str = "", rest: str = "", width: int = WIDTH) -> str:
    """The text in lines of a width;  first, rest: indents of the first line and of the others."""
    return textwrap.fill(
        text,
        width,
        initial_indent=first,
        subsequent_indent=rest,
        break_on_hyphens=False,
        break_long_words=False,
    )


def join_names(names: Sequence[str], last: str = "and") -> str:
    """Names as a list in a sentence: a, b and c."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {last} {names[-1]}"


def unit_on_page(unit: str) -> str:
    """An SI unit as printed: N*s/m as N·s/m, m^2 as m²; "" for a plain number."""
    return "" if unit == "1" else unit.replace("*", "·").replace("^2", "²").replace("^3", "³")


def unit_at_axis(unit: str) -> str:
    """A unit as printed at an axis, in mathtext."""
    return unit.replace("*", r"$\,$").replace("^2", "²")


def typeset(sentence: str) -> str:
    """A sentence of the terminal in the form of a page: capital letter, ± and units with dots."""
    first = sentence.partition(" ")[0].rstrip(",:;")
    if first.isalpha() and first.isascii():  # no number, and no key of a file
        sentence = sentence[0].upper() + sentence[1:]
    sentence = _PRODUCT.sub("·", sentence.replace(" +- ", " ± "))
    return _POWER.sub(lambda power: "²" if power[1] == "2" else "³", sentence)


#: quantities that are written in thousandths of their unit up to one unit
_LENGTHS = ("position", "velocity")


def readable_unit(quantity: str, axis: str, largest: float) -> tuple[float, str]:
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


def amount(value: float, quantity: str, axis: str) -> str:
    """A value (SI) with its unit, in a readable form: "4.0 mm/s", "0.30 N", "12 %"."""
    factor, unit = readable_unit(quantity, axis, value)
    return f"{number(factor * value)}{unit_after_number(unit)}"


def span(low: float, high: float, quantity: str, axis: str) -> str:
    """Two values (SI) with one unit: "4.0 and 20 mm/s"."""
    factor, unit = readable_unit(quantity, axis, max(abs(low), abs(high)))
    return f"{number(factor * low)} and {number(factor * high)}{unit_after_number(unit)}"

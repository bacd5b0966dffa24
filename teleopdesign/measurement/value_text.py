"""Values as the user types them: a number, with a unit where one is required."""

from __future__ import annotations

import math
import re

from ..errors import ExperimentError
from ..quantity import is_unit

_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")


def split_value(text: str) -> tuple[float, str] | None:
    """The number and the rest of a text; None: the text does not begin with a finite number."""
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None or not math.isfinite(float(match[1])):
        return None
    return float(match[1]), match[2].strip()


def number_and_unit(text: str, *, where: str, example: str) -> tuple[float, str]:
    """The number and the unit of a text such as "0.037 N*m/A", both required.

    raises ExperimentError: no number, or no unit
    """
    parts = split_value(text)
    if parts is None or not is_unit(parts[1]):
        raise ExperimentError(
            f'{where}: found {text!r}, expected a number and a unit such as "{example}"'
        )
    return parts


def motor_constant(text: str, *, where: str) -> tuple[float, str]:
    """A motor constant such as "0.037 N*m/A" or "12 N/A".

    raises ExperimentError: no number, or another unit
    """
    value, unit = number_and_unit(text, where=where, example="0.037 N*m/A")
    if not unit.endswith(("/A", "/mA", "/V")):
        raise ExperimentError(
            f"{where}: found the unit {unit!r}, expected a force or torque for each "
            'ampere or volt, such as "N*m/A" or "N/A"'
        )
    return value, unit


def plain_number(text: str, *, where: str) -> float:
    """A number without a unit; a decimal comma is accepted.

    raises ExperimentError: no number
    """
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ExperimentError(f"{where}: found {text!r}, expected a number")
    return value

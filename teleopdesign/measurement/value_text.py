"""Values as the user types them: a number, with a unit where one is required."""

from __future__ import annotations

import math
import re

from ..base.errors import ExperimentError
from ..base.units import AXES, is_unit, measures
from .column_names import unit_of_text

_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")


def split_value(text: str) -> tuple[float, str] | None:
    """The number and the rest of a text; None: the text does not begin with a finite number."""
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None or not math.isfinite(float(match[1])):
        return None
    return float(match[1]), match[2].strip()


def motor_constant(text: str, *, where: str) -> tuple[float, str]:
    """A motor constant such as "0.037 N*m/A" or "12 N/A".

    raises ExperimentError: no number, or another unit
    """
    parts = split_value(text)
    force, _, per = (parts[1] if parts else "").rpartition("/")
    force = unit_of_text(force) or ""
    if parts is None or not (is_unit(parts[1]) or is_unit(f"{force}/{per}")):
        raise ExperimentError(
            f'{where}: found {text!r}, expected a number and a unit such as "0.037 N*m/A"'
        )
    if not any(measures(force, "force", axis) for axis in AXES) or per not in ("A", "mA", "V"):
        raise ExperimentError(
            f"{where}: found the unit {parts[1]!r}, expected a force or torque for each "
            'ampere or volt, such as "N*m/A" or "N/A"'
        )
    return parts[0], f"{force}/{per}"


def lever_arm(text: str, *, where: str) -> tuple[float, str]:
    """Distance of a force from the axis, such as "70 mm".

    raises ExperimentError: no number above 0, or no unit of a length
    """
    parts = split_value(text)
    if parts is None or not parts[0] > 0 or not is_unit(parts[1] or "?"):
        raise ExperimentError(f'{where}: found {text!r}, expected a length such as "70 mm"')
    if not measures(parts[1], "position", "prismatic"):
        raise ExperimentError(
            f'{where}: found the unit {parts[1]!r}, expected one of a length such as "mm"'
        )
    return parts


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

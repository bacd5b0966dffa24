"""Values of the command line: a number, and a unit where it is not in SI."""

from __future__ import annotations

import math
import re

from ..errors import ExperimentError
from ..quantity import is_unit, to_si

_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")


def number_and_unit(text: str, *, where: str, example: str) -> tuple[float, str]:
    """The number and the unit of a text such as "0.037 N*m/A", both required.

    raises ExperimentError: no number, or no unit
    """
    match = _NUMBER_AND_UNIT.fullmatch(text)
    unit = match[2].strip() if match is not None else ""
    if match is None or not math.isfinite(float(match[1])) or not is_unit(unit):
        raise ExperimentError(
            f'{where}: found {text!r}, expected a number and a unit such as "{example}"'
        )
    return float(match[1]), unit


def value_from(text: str, *, quantity: str, axis: str, where: str) -> float:
    """The value in SI of a text such as "0.2", "45deg" or "3 N".

    where: what errors call it;  raises ExperimentError: no number, or a unit of another quantity
    """
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None or not math.isfinite(float(match[1])):
        raise ExperimentError(f"{where}: found {text!r}, expected a number and a unit")
    size, unit = float(match[1]), match[2].strip()
    return to_si(size, unit, quantity=quantity, axis=axis, where=where) if unit else size

"""Values on the command line: a number, and a unit unless the number is in SI."""

from __future__ import annotations

from itertools import product

from ..base.errors import ExperimentError
from ..base.units import AXES, QUANTITIES, to_si, unit_of


def value_from(text: str, *, quantity: str, axis: str, where: str) -> float:
    """The value in SI of a text such as "0.2", "45deg" or "3 N".

    where: beginning of an error message
    raises ExperimentError: no number, or a unit of another quantity
    """
    from ..measurement.value_text import split_value  # heavy: not for --help

    parts = split_value(text)
    if parts is None:
        raise ExperimentError(f"{where}: found {text!r}, expected a number and a unit")
    size, unit = parts
    return to_si(size, unit, quantity=quantity, axis=axis, where=where) if unit else size


def value_in(text: str, *, unit: str, where: str) -> float:
    """The value of a text such as "0.2", "5 mm" or "45deg" in the SI unit `unit`.

    where: beginning of an error message
    raises ExperimentError: no number, or a unit of another quantity
    """
    of_unit = (q for q in product(QUANTITIES, AXES) if unit_of(*q) == unit)
    quantity, axis = next(of_unit, ("dimensionless", AXES[0]))
    return value_from(text, quantity=quantity, axis=axis, where=where)

"""Values on the command line: a number, and a unit unless the number is in SI."""

from __future__ import annotations

from ..errors import ExperimentError
from ..quantity import to_si
from ..unit_text import NotAUnit, parse_unit


def value_from(text: str, *, quantity: str, axis: str, where: str) -> float:
    """The value in SI of a text such as "0.2", "45deg" or "3 N".

    where: beginning of an error message
    raises ExperimentError: no number, or a unit of another quantity
    """
    size, unit = _size_and_unit(text, where)
    return to_si(size, unit, quantity=quantity, axis=axis, where=where) if unit else size


def value_in(text: str, *, unit: str, where: str) -> float:
    """The value of a text such as "0.2", "5 mm" or "45deg" in the SI unit `unit`; "1": none.

    where: beginning of an error message
    raises ExperimentError: no number, or a unit of another quantity
    """
    size, written = _size_and_unit(text, where)
    if not written:
        return size
    try:
        read, wanted = parse_unit(written), parse_unit(unit)
    except NotAUnit as error:
        raise ExperimentError(f"{where}: found {text!r}: no unit {error.part!r}") from error
    if read.powers != wanted.powers:
        expected = "a number without a unit" if unit == "1" else f"a value in {unit}"
        raise ExperimentError(f"{where}: found {text!r}, expected {expected}")
    return size * read.scale / wanted.scale


def _size_and_unit(text: str, where: str) -> tuple[float, str]:
    from ..measurement.value_text import split_value  # heavy: not for --help

    parts = split_value(text)
    if parts is None:
        raise ExperimentError(f"{where}: found {text!r}, expected a number and a unit")
    return parts

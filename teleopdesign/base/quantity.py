"""Quantities and their units: SI inside the package, any unit of a laboratory in a file.

A quantity has one unit on a prismatic axis and another on a revolute axis (`unit_of`). A user's
unit is a product of symbols with powers and SI prefixes, such as `mm`, `N*s/m`, `N m s/rad`,
`kg*m^2` or `deg/s`; `to_si` checks that the unit fits the quantity. Radians have no dimension;
degrees, turns and rpm are converted. Currents and voltages become forces by a constant
(`converting_factor`).
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from .errors import ExperimentError, did_you_mean, quote
from .unit_text import SYMBOLS, NotAUnit, multiply, parse_unit

AXES = ("prismatic", "revolute")
#: Hz: frequencies of the mains, at which a hum appears
MAINS = (50.0, 60.0)


@dataclass(frozen=True)
class _Kind:
    """The noun for a quantity in messages, and the units shown as examples, the SI unit first."""

    noun: str
    units: tuple[str, ...]


_TIME = _Kind("a time", ("s", "ms"))
_FREQUENCY = _Kind("a frequency", ("Hz", "rad/s"))
_ANGLE = _Kind("an angle", ("rad", "deg"))
_NUMBER = _Kind("a number without dimension", ("1", "%"))
#: a part of a range or of a rated value: no angle, although both have no dimension
_PER_CENT = "%"
_TEMPERATURE = _Kind("a temperature", ("K", "mK"))
_PER_KELVIN = _Kind("a part per kelvin", ("1/K", "%/K"))

#: several times a unit of time: ticks of a clock of 8 kHz are "125 us" or "1/8000 s"
_SEVERAL = re.compile(
    r"\s*(?P<number>\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)(?:\s*/\s*(?P<parts>[1-9]\d*))?"
    r"\s+(?P<unit>[A-Za-zµμ]+)\s*"
)

#: a frequency, which as a speed of rotation counts turns
_HERTZ = re.compile(r"[a-zA-Zµμ]?Hz")

# quantity -> (on a prismatic axis, on a revolute axis)
QUANTITIES: Mapping[str, tuple[_Kind, _Kind]] = {
    "time": (_TIME, _TIME),
    "position": (_Kind("a length", ("m", "mm")), _ANGLE),
    "velocity": (
        _Kind("a velocity", ("m/s", "mm/s")),
        _Kind("an angular velocity", ("rad/s", "deg/s")),
    ),
    "acceleration": (
        _Kind("an acceleration", ("m/s^2", "mm/s^2")),
        _Kind("an angular acceleration", ("rad/s^2", "deg/s^2")),
    ),
    "force": (_Kind("a force", ("N", "mN")), _Kind("a torque", ("N*m", "mNm"))),
    "energy": (_Kind("an energy", ("J", "mJ")), _Kind("an energy", ("J", "mJ"))),
    "inertia": (_Kind("a mass", ("kg", "g")), _Kind("a moment of inertia", ("kg*m^2", "g*cm^2"))),
    "damping": (
        _Kind("a damping", ("N*s/m", "N*s/mm")),
        _Kind("a rotary damping", ("N*m*s/rad", "mNm*s/rad")),
    ),
    "stiffness": (
        _Kind("a stiffness", ("N/m", "N/mm")),
        _Kind("a rotary stiffness", ("N*m/rad", "N*m/deg")),
    ),
    "drag": (
        _Kind("a quadratic drag", ("N*s^2/m^2", "kg/m")),
        _Kind("a rotary quadratic drag", ("N*m*s^2/rad^2", "mNm*s^2/rad^2")),
    ),
    "cubic_stiffness": (
        _Kind("a cubic stiffness", ("N/m^3", "N/mm^3")),
        _Kind("a rotary cubic stiffness", ("N*m/rad^3", "mNm/rad^3")),
    ),
    "per_square_of_position": (
        _Kind("a part per length squared", ("1/m^2", "1/mm^2")),
        _Kind("a part per angle squared", ("1/rad^2", "1/deg^2")),
    ),
    "temperature": (_TEMPERATURE, _TEMPERATURE),
    "temperature_coefficient": (_PER_KELVIN, _PER_KELVIN),
    "frequency": (_FREQUENCY, _FREQUENCY),
    "angle": (_ANGLE, _ANGLE),
    "dimensionless": (_NUMBER, _NUMBER),
}


def unit_of(quantity: str, axis: str) -> str:
    """The SI unit in which `quantity` is stored and shown: "N*m" for a force on a revolute axis.

    axis: "prismatic" or "revolute"
    raises ExperimentError: no such quantity or axis
    """
    return _kind(quantity, axis, "").units[0]


def noun_of(quantity: str, axis: str) -> str:
    """What `quantity` is called on `axis`: "a torque"; errors as those of `unit_of`."""
    return _kind(quantity, axis, "").noun


def unit_after_number(unit: str) -> str:
    """A unit as it stands behind a number: " N*m"; "" for a number without dimension."""
    return "" if unit in ("", "1") else f" {unit}"


def to_si(
    value: float, unit: str | None, *, quantity: str, axis: str = "prismatic", where: str = ""
) -> float:
    """`value`, given in `unit`, converted to the SI unit of `quantity` on `axis` (see `unit_of`).

    unit: None is allowed for an angle and for a quantity without dimension
    where: file and key, the beginning of an error message
    raises ExperimentError: not a unit, a unit of another quantity, or a result that is not finite
    """
    result = value * si_factor(unit, quantity=quantity, axis=axis, where=where)
    if not math.isfinite(result):
        raise ExperimentError(f"{_begin(where)}found {value:g} {unit}, expected a finite number")
    return result


def si_factor(
    unit: str | None, *, quantity: str, axis: str = "prismatic", where: str = ""
) -> float:
    """Factor from `unit` to the SI unit of `quantity`; arguments and errors as for `to_si`.

    A time may be several times a unit, as ticks of a clock are: "125 us", "1/8000 s".
    """
    kind = _kind(quantity, axis, where)
    if quantity == "time" and unit is not None and (seconds := _several_times(unit)):
        return seconds
    expected = f"expected {kind.noun} such as " + " or ".join(quote(u) for u in kind.units)
    if unit is None:
        if quantity in ("dimensionless", "angle"):
            return 1.0
        raise ExperimentError(f"{_begin(where)}no unit, {expected}")
    try:
        parsed = parse_unit(unit)
    except NotAUnit as problem:
        hint = did_you_mean(unit, kind.units) or did_you_mean(problem.part, SYMBOLS)
        raise ExperimentError(f"{_begin(where)}found {quote(unit)}, {expected}{hint}") from None
    wanted = parse_unit(kind.units[0])
    if parsed.dimension != wanted.dimension or _is_part(unit, kind):
        raise ExperimentError(f"{_begin(where)}found {quote(unit)}, {expected}")
    if quantity == "frequency" and parsed.powers[-1] == 1:
        return parsed.scale / (2 * math.pi)  # an angular frequency in rad/s or rpm; Hz counts turns
    return parsed.scale * _turns_in(unit, quantity, axis)


def converting_factor(
    unit: str, constant: str | None, *, quantity: str, axis: str = "prismatic", where: str = ""
) -> float:
    """Factor from `unit` to the SI unit of `quantity` after multiplication by a constant.

    A current in A times a torque constant in N*m/A is a torque. An angle in turns over a ratio in
    rad/mm, written as the constant `mm/rad`, is a length.

    constant: the unit of the constant; None: without dimension
    raises ExperimentError: not units, or their product is not a unit of this quantity
    """
    kind = _kind(quantity, axis, where)
    parts = []
    for text in (unit, constant or "1"):
        try:
            parts.append(parse_unit(text))
        except NotAUnit as problem:
            hint = did_you_mean(problem.part, SYMBOLS)
            raise ExperimentError(
                f"{_begin(where)}found {quote(text)}, expected a unit such as "
                f"{quote('A')} or {quote(kind.units[0])}{hint}"
            ) from None
    product, wanted = multiply(parts[0], parts[1], 1, unit), parse_unit(kind.units[0])
    if product.dimension != wanted.dimension:
        raise ExperimentError(
            f"{_begin(where)}found {quote(unit)} times {quote(constant or '1')}, "
            f"expected {kind.noun} such as {quote(kind.units[0])}"
        )
    return product.scale * _turns_in(unit, quantity, axis)


def _turns_in(unit: str, quantity: str, axis: str) -> float:
    """Angle in rad that a speed of one counts: in Hz it counts turns, in 1/s it counts rad."""
    is_speed = quantity == "velocity" and axis == "revolute"
    return 2 * math.pi if is_speed and _HERTZ.fullmatch(unit.strip()) else 1.0


def is_unit(text: str) -> bool:
    """Whether a text can be read as a unit: "N*m/A" can, "Pos" cannot."""
    try:
        parse_unit(text)
    except NotAUnit:
        return False
    return True


def is_several_times(text: str) -> bool:
    """Whether a text is a number above zero and a unit of time: "125 us", "1/8000 s"."""
    return _several_times(text) > 0.0


def _several_times(text: str) -> float:
    """A number times a unit of time, in s; 0 for any other text."""
    match = _SEVERAL.fullmatch(text)
    if match is None or not measures(match["unit"], "time"):
        return 0.0
    return float(match["number"]) / int(match["parts"] or 1) * parse_unit(match["unit"]).scale


def measures(unit: str, quantity: str, axis: str = "prismatic") -> bool:
    """Whether `unit` is a unit of that quantity on that axis."""
    try:
        parsed = parse_unit(unit)
    except NotAUnit:
        return False
    kind = _kind(quantity, axis, "")
    return parsed.dimension == parse_unit(kind.units[0]).dimension and not _is_part(unit, kind)


def _is_part(unit: str, kind: _Kind) -> bool:
    """Whether a unit is a part of a whole where an angle is wanted: "Valve position [%]"."""
    return kind is _ANGLE and unit.strip() == _PER_CENT


def _kind(quantity: str, axis: str, where: str) -> _Kind:
    if quantity not in QUANTITIES:
        raise ExperimentError(
            f"{_begin(where)}no quantity {quote(quantity)}, expected one of "
            f"{', '.join(QUANTITIES)}{did_you_mean(quantity, QUANTITIES)}"
        )
    if axis not in AXES:
        raise ExperimentError(
            f"{_begin(where)}no axis {quote(axis)}, expected {' or '.join(AXES)}"
            f"{did_you_mean(axis, AXES)}"
        )
    return QUANTITIES[quantity][AXES.index(axis)]


def _begin(where: str) -> str:
    return f"{where}: " if where else ""

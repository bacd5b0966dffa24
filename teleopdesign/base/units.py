"""Quantities and their units: SI inside the package, any unit of a laboratory in a file.

A quantity has one unit on a prismatic axis and another on a revolute axis (`unit_of`). A user's
unit is a product of symbols with powers and SI prefixes, such as `mm`, `N*s/m`, `N m s/rad`,
`kg*m^2` or `deg/s`; `to_si` checks that the unit fits the quantity. Radians have no dimension;
degrees, turns and rpm are converted. Currents and voltages become forces by a constant
(`converting_factor`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from .errors import ExperimentError, did_you_mean, quote


@dataclass(frozen=True)
class ParsedUnit:
    """`scale` times kg^a m^b s^c A^d K^e rad^f; `powers` is (a, b, c, d, e, f)."""

    scale: float
    powers: tuple[int, ...]

    @property
    def dimension(self) -> tuple[int, ...]:
        """The powers except the power of the radian, which has no dimension."""
        return self.powers[:-1]


_PREFIXES = {"n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "c": 1e-2, "d": 1e-1}
_PREFIXES |= {"k": 1e3, "M": 1e6, "G": 1e9}
_PREFIXED = {
    "m": ParsedUnit(1.0, (0, 1, 0, 0, 0, 0)),
    "g": ParsedUnit(1e-3, (1, 0, 0, 0, 0, 0)),
    "s": ParsedUnit(1.0, (0, 0, 1, 0, 0, 0)),
    "N": ParsedUnit(1.0, (1, 1, -2, 0, 0, 0)),
    "J": ParsedUnit(1.0, (1, 2, -2, 0, 0, 0)),
    "Nm": ParsedUnit(1.0, (1, 2, -2, 0, 0, 0)),
    "Nms": ParsedUnit(1.0, (1, 2, -1, 0, 0, 0)),
    "Hz": ParsedUnit(1.0, (0, 0, -1, 0, 0, 0)),
    "A": ParsedUnit(1.0, (0, 0, 0, 1, 0, 0)),
    "V": ParsedUnit(1.0, (1, 2, -3, -1, 0, 0)),
    "K": ParsedUnit(1.0, (0, 0, 0, 0, 1, 0)),
    "rad": ParsedUnit(1.0, (0, 0, 0, 0, 0, 1)),
}
#: symbol -> its prefixes in use, if not all are: other combinations are other words. "Grad" is the
#: German degree and no gigaradian; "Mm" and "MA" are typing errors
_IN_USE = {"rad": "nuµμmk", "m": "nuµμmcdk", "s": "nuµμmcdk", "A": "nuµμmk", "V": "nuµμmk"}
#: every symbol that a unit may contain, those with prefixes included
SYMBOLS = {
    "1": ParsedUnit(1.0, (0, 0, 0, 0, 0, 0)),
    "%": ParsedUnit(1e-2, (0, 0, 0, 0, 0, 0)),
    "Nmm": ParsedUnit(1e-3, (1, 2, -2, 0, 0, 0)),
    "min": ParsedUnit(60.0, (0, 0, 1, 0, 0, 0)),
    "day": ParsedUnit(86_400.0, (0, 0, 1, 0, 0, 0)),
    "deg": ParsedUnit(math.pi / 180, (0, 0, 0, 0, 0, 1)),
    "°": ParsedUnit(math.pi / 180, (0, 0, 0, 0, 0, 1)),
    "rev": ParsedUnit(2 * math.pi, (0, 0, 0, 0, 0, 1)),
    "turn": ParsedUnit(2 * math.pi, (0, 0, 0, 0, 0, 1)),
    "turns": ParsedUnit(2 * math.pi, (0, 0, 0, 0, 0, 1)),
    "rpm": ParsedUnit(2 * math.pi / 60, (0, 0, -1, 0, 0, 1)),
    "in": ParsedUnit(0.0254, (0, 1, 0, 0, 0, 0)),
    "inch": ParsedUnit(0.0254, (0, 1, 0, 0, 0, 0)),
    "ft": ParsedUnit(0.3048, (0, 1, 0, 0, 0, 0)),
    "gf": ParsedUnit(9.80665e-3, (1, 1, -2, 0, 0, 0)),
    "kgf": ParsedUnit(9.80665, (1, 1, -2, 0, 0, 0)),
    "lbf": ParsedUnit(0.45359237 * 9.80665, (1, 1, -2, 0, 0, 0)),
    "ozf": ParsedUnit(0.45359237 * 9.80665 / 16, (1, 1, -2, 0, 0, 0)),
    **_PREFIXED,
}
SYMBOLS |= {
    prefix + name: ParsedUnit(factor * unit.scale, unit.powers)
    for name, unit in _PREFIXED.items()
    for prefix, factor in _PREFIXES.items()
    if prefix in _IN_USE.get(name, _PREFIXES)
    and prefix + name not in SYMBOLS  # "min" and the like are no prefixed unit
}

#: a point or a hyphen between letters is a product: "N.m", "N-m"; behind a slash it is ambiguous
_TOKEN = re.compile(r"\s*(\*\*|[*·⋅/^()²³]|[A-Za-zµμ°%]+|[-+]?\d+|(?<=[A-Za-z])[.-](?=[A-Za-z]))")
_BETWEEN_LETTERS = (".", "-")
_TIMES = ("*", "·", "⋅", *_BETWEEN_LETTERS)
_LONGEST_UNIT = 60  # characters; also bounds the nesting of brackets
_LARGEST_POWER = 4
_SCALES = (1e-40, 1e40)


class NotAUnit(Exception):
    """A text contains a part that is not a unit.

    part: that part of the text
    """

    def __init__(self, part: str) -> None:
        super().__init__(part)
        self.part = part


def parse_unit(text: str) -> ParsedUnit:
    """The unit that a text of at most 60 characters describes; raises NotAUnit."""
    if not 0 < len(text) <= _LONGEST_UNIT:
        raise NotAUnit(text)
    tokens, position = [], 0
    stripped = text.rstrip()
    while position < len(stripped):
        match = _TOKEN.match(stripped, position)
        if match is None:
            raise NotAUnit(text)
        tokens.append(match.group(1))
        position = match.end()
    unit, rest = _product(tokens, text)
    if rest:
        raise NotAUnit(text)
    return unit


def multiply(unit: ParsedUnit, factor: ParsedUnit, power: int, text: str) -> ParsedUnit:
    """unit * factor^power; raises NotAUnit if the scale leaves the range from 1e-40 to 1e40.

    text: the whole text of the unit, for the error
    """
    scale = unit.scale * factor.scale**power
    if not _SCALES[0] < scale < _SCALES[1]:
        raise NotAUnit(text)
    powers = (u + power * f for u, f in zip(unit.powers, factor.powers, strict=True))
    return ParsedUnit(scale, tuple(powers))


def _product(tokens: list[str], text: str) -> tuple[ParsedUnit, list[str]]:
    """Product or quotient from left to right, up to the end or a closing bracket; unread tokens."""
    unit, tokens = _factor(tokens, text)
    divided = False
    while tokens and tokens[0] != ")":
        sign = -1 if tokens[0] == "/" else 1
        divided |= tokens[0] == "/"
        if divided and tokens[0] in _BETWEEN_LETTERS:
            raise NotAUnit(text)
        if tokens[0] in (*_TIMES, "/"):
            tokens = tokens[1:]
        factor, tokens = _factor(tokens, text)
        unit = multiply(unit, factor, sign, text)
    return unit, tokens


def _factor(tokens: list[str], text: str) -> tuple[ParsedUnit, list[str]]:
    """The unit of a symbol with its power, or of a bracket; and the unread tokens."""
    if not tokens:
        raise NotAUnit(text)
    name, tokens = tokens[0], tokens[1:]
    if name == "(":
        unit, tokens = _product(tokens, text)
        if not tokens:
            raise NotAUnit(text)
        return unit, tokens[1:]
    if name not in SYMBOLS:
        raise NotAUnit(name)
    power = 1
    if tokens and tokens[0] in "²³":
        power, tokens = "²³".index(tokens[0]) + 2, tokens[1:]
    elif tokens and tokens[0] in ("^", "**"):
        if len(tokens) < 2 or not re.fullmatch(r"[-+]?\d", tokens[1]):
            raise NotAUnit(text)
        power, tokens = int(tokens[1]), tokens[2:]
    if abs(power) > _LARGEST_POWER:
        raise NotAUnit(text)
    return multiply(SYMBOLS["1"], SYMBOLS[name], power, text), tokens


AXES = ("prismatic", "revolute")
#: Hz: frequencies of the mains, at which a hum appears
MAINS = (50.0, 60.0)


@dataclass(frozen=True)
class _Kind:
    """The noun for a quantity in messages, and the units shown as examples, the SI unit first."""

    noun: str
    units: tuple[str, ...]

    @classmethod
    def of(cls, text: str) -> _Kind:
        """The kind of a text such as "a length: m, mm"."""
        noun, _, units = text.partition(": ")
        return cls(noun, tuple(units.split(", ")))


#: a part of a range or of a rated value: no angle, although both have no dimension
_PER_CENT = "%"
#: several times a unit of time: ticks of a clock of 8 kHz are "125 us" or "1/8000 s"
_SEVERAL = re.compile(
    r"\s*(?P<number>\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)(?:\s*/\s*(?P<parts>[1-9]\d*))?"
    r"\s+(?P<unit>[A-Za-zµμ]+)\s*"
)

#: a frequency, which as a speed of rotation counts turns
_HERTZ = re.compile(r"[a-zA-Zµμ]?Hz")

#: quantity -> its noun and units on a prismatic axis, and on a revolute axis if they differ there
_NOUNS = {
    "time": ("a time: s, ms",),
    "position": ("a length: m, mm", "an angle: rad, deg"),
    "velocity": ("a velocity: m/s, mm/s", "an angular velocity: rad/s, deg/s"),
    "acceleration": (
        "an acceleration: m/s^2, mm/s^2",
        "an angular acceleration: rad/s^2, deg/s^2",
    ),
    "force": ("a force: N, mN", "a torque: N*m, mNm"),
    "energy": ("an energy: J, mJ",),
    "inertia": ("a mass: kg, g", "a moment of inertia: kg*m^2, g*cm^2"),
    "damping": ("a damping: N*s/m, N*s/mm", "a rotary damping: N*m*s/rad, mNm*s/rad"),
    "stiffness": ("a stiffness: N/m, N/mm", "a rotary stiffness: N*m/rad, N*m/deg"),
    "drag": (
        "a quadratic drag: N*s^2/m^2, kg/m",
        "a rotary quadratic drag: N*m*s^2/rad^2, mNm*s^2/rad^2",
    ),
    "cubic_stiffness": (
        "a cubic stiffness: N/m^3, N/mm^3",
        "a rotary cubic stiffness: N*m/rad^3, mNm/rad^3",
    ),
    "per_square_of_position": (
        "a part per length squared: 1/m^2, 1/mm^2",
        "a part per angle squared: 1/rad^2, 1/deg^2",
    ),
    "temperature": ("a temperature: K, mK",),
    "temperature_coefficient": ("a part per kelvin: 1/K, %/K",),
    "frequency": ("a frequency: Hz, rad/s",),
    "angle": ("an angle: rad, deg",),
    "dimensionless": ("a number without dimension: 1, %",),
}
#: quantity -> (on a prismatic axis, on a revolute axis)
QUANTITIES: Mapping[str, tuple[_Kind, _Kind]] = {
    name: (_Kind.of(texts[0]), _Kind.of(texts[-1])) for name, texts in _NOUNS.items()
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
        is_weight = quantity == "force" and f"{unit}f" in SYMBOLS
        hint = f"; as a weight it is in {quote(f'{unit}f')}" if is_weight else ""
        raise ExperimentError(f"{_begin(where)}found {quote(unit)}, {expected}{hint}")
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
    return kind.noun == "an angle" and unit.strip() == _PER_CENT


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

"""Units as text: products of symbols with powers and SI prefixes, such as "N m s/rad"."""

import math
import re
from dataclasses import dataclass


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

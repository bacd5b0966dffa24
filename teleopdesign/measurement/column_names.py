"""What the name of a column says: its unit ("Pos (deg)", "i_A", "t [ms]") and what it may be."""

from __future__ import annotations

import re

from ..quantity import is_unit, measures
from .conversion import COUNTS

#: how loggers write units -> as this package reads them
ALIASES = {
    "degree": "deg", "degrees": "deg", "grad": "deg", "radian": "rad", "radians": "rad",
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "sekunden": "s", "msec": "ms",
    "millis": "ms", "milliseconds": "ms", "usec": "us", "micros": "us", "amp": "A", "amps": "A",
    "ampere": "A", "amperes": "A", "a": "A", "ma": "mA", "newton": "N", "newtons": "N", "n": "N",
    "nm": "Nm", "ncm": "N*cm", "meter": "m", "meters": "m", "millimeter": "mm", "millimeters": "mm",
    "revs": "rev", "revolutions": "turns", "ticks": "counts", "cnt": "counts", "count": "counts",
    "inc": "counts", "volt": "V", "volts": "V", "v": "V", "rads": "rad/s", "degs": "deg/s",
    "u/min": "rpm", "1/min": "rpm", "min-1": "rpm",
}  # fmt: skip
_BRACKETS = re.compile(r"[(\[{]\s*([^()\[\]{}]+?)\s*[)\]}]\s*$")
_TAIL = re.compile(r"(?:_|\s|/)([A-Za-zµ°%][A-Za-z0-9µ°%^*/·]*)$")

#: quantity -> words that a name of it may hold, the surest first
WORDS: dict[str, tuple[str, ...]] = {
    "time": ("time", "timestamp", "zeit", "stamp", "temps", "t", "seconds"),
    "position": (
        "position", "pos", "angle", "winkel", "weg", "theta", "enc", "encoder", "phi", "q", "x",
        "actualq",
    ),
    "velocity": (
        "velocity", "vel", "speed", "geschwindigkeit", "drehzahl", "omega", "qd", "dq", "xd", "v",
    ),
    "interaction_force": (
        "interaction", "hand", "contact", "external", "ext", "sensor", "wrench", "fh", "ft", "load",
    ),
    "actuator_force": (
        "torque", "current", "strom", "moment", "drehmoment", "effort", "motor", "command", "cmd",
        "tau", "force", "kraft", "u", "i", "f", "control",
    ),
    "segment": ("segment", "run", "trial"),
}  # fmt: skip
#: words of what was wanted, and no reading of a sensor
WANTED = (
    "target",
    "ref",
    "reference",
    "desired",
    "des",
    "setpoint",
    "soll",
    "goal",
    "cmd",
    "command",
)


def bare_name(name: str) -> str:
    """A name without the unit in brackets at its end."""
    return _BRACKETS.sub("", name).strip()


def unit_in_name(name: str, quantity: str | None = None, axis: str = "prismatic") -> str | None:
    """The unit that a column's name ends with, as the package writes it; None: it says none.

    quantity: what the column is, if that is known: what is no unit of it is a part of the name
    """
    match = _BRACKETS.search(name)
    tail = _TAIL.search(name)
    for text, sure in ((match, True), (tail, False)):
        if text is None:
            continue
        unit = unit_of_text(text.group(1))
        if unit is None or not sure and len(text.group(1)) < 2 and quantity is None:
            continue
        if quantity is None or _suits(unit, quantity, axis):
            return unit
    return None


def unit_of_text(text: str) -> str | None:
    """A unit as a logger writes it ("degrees", "Amps", "ticks"); None: none."""
    text = text.strip()
    if text.lower() in ALIASES and not is_unit(text):
        return ALIASES[text.lower()]
    if text == "nm":  # a nanometre in the units of physics, a torque in a log
        return "Nm"
    if text in COUNTS:
        return "counts"
    return text if is_unit(text) and not text.isdigit() else None


def _suits(unit: str, quantity: str, axis: str) -> bool:
    if unit == "counts":
        return quantity == "position"
    if quantity == "force":
        return measures(unit, "force", axis) or unit in ("A", "mA", "V", "%")
    return measures(unit, quantity, axis)


def words_of(name: str) -> list[str]:
    """The words of a name in lower case: "Actual_Pos2 (deg)" -> actual, pos."""
    bare = re.sub(r"([a-z])([A-Z])", r"\1 \2", bare_name(name))
    return [w for w in re.split(r"[^a-zA-Zäöüß]+", bare.lower()) if w]


def likeness(name: str, quantity: str) -> float:
    """How much a name sounds like a quantity: 0 to 1."""
    words = words_of(name)
    if len(words) > 1 and all(len(w) == 1 for w in words):
        words.append("".join(words))  # a letter with its index: "f_h"
    listed = WORDS[quantity]
    best = 0.0
    for word in words:
        for rank, known in enumerate(listed):
            exact = word == known
            if exact or len(known) > 3 and word.startswith(known):
                best = max(best, (1.0 if exact else 0.9) - 0.02 * rank)
    return best


def is_wanted(name: str) -> bool:
    """Whether a name says that its column is what was asked for, not what was read."""
    return any(word in WANTED for word in words_of(name))

"""Unit and quantity from the name of a column: "Pos (deg)", "i_A", "t [ms]"."""

from __future__ import annotations

import itertools
import re
import unicodedata
from collections.abc import Collection, Iterator
from functools import lru_cache

from ..base.units import is_unit, measures, noun_of
from .conversion import COUNTS
from .doors._log import bare_column

#: unit as loggers write it -> unit as this package reads it
ALIASES = {
    "degree": "deg", "degrees": "deg", "grad": "deg", "radian": "rad", "radians": "rad",
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "sekunden": "s", "msec": "ms",
    "millis": "ms", "milliseconds": "ms", "usec": "us", "micros": "us", "amp": "A", "amps": "A",
    "ampere": "A", "amperes": "A", "a": "A", "ma": "mA", "newton": "N", "newtons": "N", "n": "N",
    "nm": "Nm", "ncm": "N*cm", "meter": "m", "meters": "m", "millimeter": "mm", "millimeters": "mm",
    "revs": "rev", "revolutions": "turns", "ticks": "counts", "cnt": "counts", "count": "counts",
    "inc": "counts", "incr": "counts", "ink": "counts", "inkr": "counts", "inkremente": "counts",
    "qc": "counts", "pulses": "counts", "impulse": "counts", "volt": "V", "volts": "V", "v": "V",
    "rads": "rad/s", "degs": "deg/s",
    "с": "s", "мс": "ms", "град": "deg", "рад": "rad", "м": "m", "мм": "mm", "н": "N",
    "нм": "Nm", "н·м": "Nm", "н*м": "Nm", "а": "A", "°": "deg", "度": "deg", "秒": "s", "초": "s",
    "u/min": "rpm", "1/min": "rpm", "min-1": "rpm", "r/min": "rpm", "tr/min": "rpm",
    "об/мин": "rpm", "度/秒": "deg/s", "度/s": "deg/s", "град/с": "deg/s", "рад/с": "rad/s",
    "м/с": "m/s", "мм/с": "mm/s", "弧度": "rad", "弧度/秒": "rad/s", "毫秒": "ms", "微秒": "us",
    "安": "A", "牛": "N", "牛米": "Nm", "牛·米": "Nm", "毫米": "mm", "米": "m", "毫米/秒": "mm/s",
    "米/秒": "m/s", "ミリ秒": "ms", "ラジアン": "rad", "도": "deg", "days": "day",
    "tage": "day", "jours": "day", "grad/s": "deg/s", "grad/sec": "deg/s", "degree/s": "deg/s",
    "degrees/s": "deg/s", "newtonmeter": "Nm", "sekunde": "s", "millisekunden": "ms",
    "grd": "deg", "umdrehungen": "turns", "umdr": "turns", "min^-1": "rpm", "dps": "deg/s",
    "inches": "in", "lb": "lbf", "lbs": "lbf", "rps": "turns/s", "r/s": "turns/s", "u/s": "turns/s",
    "mm": "mm", "ms": "ms", "us": "us", "s": "s", "rad": "rad", "deg": "deg",  # "MM", "Deg"
    "arms": "A",
}  # fmt: skip
#: text in brackets at the end of a name; a number there counts axes: "pos (5)", "tau[1]"
_BRACKETS = re.compile(r"[(\[{](?=\s*[^\s()\[\]{}])(?!\s*\d+\s*[)\]}])([^()\[\]{}]++)[)\]}]\s*+$")
#: a torque as a weight at a lever: "oz-in", "ft lbs", "kg*cm", as motors' sheets write it
_WEIGHT_AT_LEVER = re.compile(
    r"(?P<weight>oz|lb|kg)s?[-*·⋅. ]?(?P<lever>in|ft|cm)"
    r"|(?P<arm>in|ft|cm)[-*·⋅. ]?(?P<load>oz|lb|kg)s?",
    re.I,
)
#: a unit per second: "deg/sec", "revs per second"
_PER_SECOND = re.compile(r"(.*[^\s/])\s*(?:/|\bper\b)\s*(?:s|secs?|seconds?|с|с\.|秒|초)", re.I)
#: units of two parts as names of columns write them: "v_mm_s", "meters_per_sec", "tau_N_m"
_OF_TWO = re.compile(
    r"(?:^|_|\s)(?:(?P<length>rad|deg|rev|mm|um|m|[a-z]+(?=_per))_(?:per_)?(?:s|sec|second)"
    r"|(?P<force>m?N)_(?P<arm>c?m))$"
)
#: an object of a field bus: "0x6077:00"; and the words for those of drives (CiA 402)
_ADDRESS = re.compile(r"\b0[xX]([0-9A-Fa-f]{2,8})(?::\d+)?\b")
_OBJECTS = {
    "6062": "target position", "6063": "position", "6064": "position", "606b": "target velocity",
    "606c": "velocity", "6071": "target torque", "6074": "target torque", "6077": "torque",
    "6078": "current", "607a": "target position", "60ff": "target velocity",
}  # fmt: skip
#: "angle / °", as ISO 80000 writes it: with spaces, so that "pos/vel" is a name
_SLASH = re.compile(r"\s/\s+\(?([^()/]+(?:/[^()/]+)?)\)?\s*$")
_TAIL = re.compile(r"(?:_|\s|/)([A-Za-zµ°%][A-Za-z0-9µ°%^*/·]*)$")

#: quantity -> words in names of its columns, the most certain words first
WORDS: dict[str, tuple[str, ...]] = {
    "time": ("time", "timestamp", "zeit", "stamp", "temps", "t", "seconds", "tiempo", "tempo", "ts",
             "時間", "时间", "時刻", "시간", "время"),
    "position": (
        "position", "pos", "angle", "winkel", "weg", "theta", "enc", "encoder", "phi", "q", "x",
        "actualq", "posicion", "posizione", "angulo", "angolo", "位置", "角度", "位移",
        "위치", "각도", "положение", "угол", "displacement", "displ", "disp", "stroke",
        "verschiebung", "deplacement", "desplazamiento", "spostamento", "変位", "변위",
        "перемещение",
    ),
    "velocity": (
        "velocity", "vel", "speed", "geschwindigkeit", "drehzahl", "omega", "qd", "dq", "xd", "v",
        "vitesse", "velocidad", "velocita", "速度",
        "속도", "скорость", "rpm", "velocities",
    ),
    "interaction_force": (
        "interaction", "hand", "contact", "external", "ext", "sensor", "wrench", "fh", "ft", "load",
        "mano", "操作力", "外力", "手", "손", "рука", "руки",
    ),
    "actuator_force": (
        "torque", "current", "strom", "moment", "drehmoment", "effort", "motor", "command", "cmd",
        "tau", "force", "kraft", "u", "i", "f", "control", "couple", "courant", "corriente",
        "corrente", "coppia", "par", "fuerza", "forza", "トルク", "電流", "电流", "力矩", "指令",
        "扭矩", "토크", "전류", "момент", "ток", "сила", "cur", "curr", "amps", "iq",
        "voltage", "spannung", "uq", "vq", "pwm", "duty",
    ),
    "segment": ("segment", "run", "trial", "repetition", "versuch", "essai"),
}  # fmt: skip
#: index in these lists from which all words count as equally certain
LAST_RANK = 12
#: words in names of commanded values, which are no readings of a sensor
WANTED = tuple(
    "target ref reference desired des setpoint sp set soll goal cmd command commanded".split()
)


#: pairs of words that are one term -> the word or quantity that they mean (ROS; field of a motor);
#: short words of drives, force sensors, simulators (MuJoCo); endings of a position's derivatives
TERMS = {("set", "point"): "setpoint", ("process", "value"): "position", ("q", "axis"): "qaxis"}
TERMS |= {("i", "q"): "iq", ("u", "q"): "uq"} | {("q", "current"): "iq", ("current", "q"): "iq"}
SHORT = dict.fromkeys(("tor", "torq", "trq", "tq"), "torque")
SHORT |= {"qpos": "q", "qvel": "qd", "qacc": "acceleration", "qfrc": "force", "ctrl": "control"}
SHORT |= dict.fromkeys(("fx", "fy", "fz"), "f")
DERIVATIVES = {"dot": "velocity", "ddot": "acceleration"}
#: words and units of quantities that are neither a position, a speed nor a force
OTHER_QUANTITIES = frozenset(
    "pressure press druck pression bar mbar psi pa kpa mpa hpa temperature temp temperatur celsius "
    "degc kelvin humidity flow".split()
)
#: units of further such quantities, which are names as well ("w" of an angular velocity)
OTHER_UNITS = OTHER_QUANTITIES | frozenset("°c c w kw mw db ohm".split())

#: words beside which "x" is a direction and no position: "ForceX", "acc_x"
ALONG = frozenset("force torque moment effort wrench vel velocity speed acc accel gyro mag".split())
#: units that are words as well: "x_in" is an input, "hand_ft" force and torque, "Arms" are A (rms)
_ONLY_IN_BRACKETS = ("in", "ft", "arms")
#: quotes at the end of a name, as dSPACE writes paths: `"Model Root"/"Plant"/"x [mm]"`
_QUOTES = "\"'"
#: most letters of a text in brackets that may be a unit, without a sign of a product
_UNIT_LETTERS = 5
#: letters that a word exceeds that ends a compound: "Motorstrom", "Schleppfehler"
COMPOUND = 4
#: least letters of a name that is a unit and nothing else; a shorter one is a symbol such as "s"
_WHOLE_NAME = 3

#: beginnings of words with the same meaning as in WANTED: "Sollwinkel", "targetPosition"
WANTED_BEGINNINGS = tuple("soll target desired demand setpoint referen consigne 目標 指令".split())


def bare_name(name: str) -> str:
    """The name of a column without the unit at its end ("Pos (deg)", "angle / °")."""
    bare = _BRACKETS.sub("", bare_column(name).rstrip(_QUOTES)).rstrip(" /").strip()
    slash = _SLASH.search(bare)
    return bare[: slash.start()] if slash and unit_of_text(slash.group(1)) else bare


def unit_in_name(name: str, quantity: str | None = None, axis: str = "prismatic") -> str | None:
    """The unit at the end of a column's name, as the package writes it; None: the name has no unit.

    quantity: what the column is, if known: an ending that is no unit of this quantity belongs to
        the name
    """
    units = _units_at_end(bare_column(name).rstrip(_QUOTES), is_known=quantity is not None)
    suits = (u for u in units if u and (quantity is None or _suits(u, quantity, axis)))
    return next(suits, None)


def _units_at_end(name: str, *, is_known: bool) -> Iterator[str | None]:
    """What may be the unit at the end of a name, the surest first.

    is_known: whether the quantity is known: then one letter may be a unit
    """
    brackets, slash, of_two, tail = (
        pattern.search(name) for pattern in (_BRACKETS, _SLASH, _OF_TWO, _TAIL)
    )
    if of_two and not brackets:
        length = of_two["length"]
        yield unit_of_text(f"{length} per s" if length else f"{of_two['force']}*{of_two['arm']}")
    yield from (unit_of_text(match[1]) for match in (brackets, slash) if match)
    if tail and tail[1].lower() not in _ONLY_IN_BRACKETS and (is_known or len(tail[1]) > 1):
        yield unit_of_text(tail[1])
    if len(name) >= _WHOLE_NAME:  # "counts", "volts"
        yield unit_of_text(name)


def unfit_unit(name: str) -> str | None:
    """What a name writes in brackets at its end or behind a slash, where that may be a unit.

    Asked where `unit_in_name` finds no unit of the column's quantity: "Hand [N]" of a torque,
    "Pos [px]". A word such as "(filtered)" or "(cmd)" is none.
    """
    name = bare_column(name).rstrip(_QUOTES)
    match = _BRACKETS.search(name) or _SLASH.search(name)
    if match is None:
        return None
    text = match.group(1).strip()
    if unit_of_text(text) is not None or not text.isalpha() and any(map(str.isalpha, text)):
        return text
    words = {*itertools.chain.from_iterable(WORDS.values()), *WANTED}
    short = text.isalpha() and len(text) <= _UNIT_LETTERS
    return text if short and text.lower() not in words else None


def why_no_unit(name: str, stated: str | None, quantity: str, axis: str) -> str:
    """Why the unit of a column is a guess: none is stated, none that is known, or another's.

    stated: the unit in a row of units, or in an attribute of the column
    """
    text = stated or unfit_unit(name)
    if text is None:
        return f"the name {name!r} states no unit"
    unit = unit_of_text(text)
    if unit is None:
        return f"{text!r}, of {name!r}, is no unit that is known"
    return f"{text!r}, of {name!r}, is no unit of {noun_of(quantity, axis)}"


def unit_of_text(text: str) -> str | None:
    """The package's unit for a unit that a logger writes ("degrees", "Amps"); None: no unit."""
    text = text.strip()
    if weight := _WEIGHT_AT_LEVER.fullmatch(text):
        load, lever = weight["weight"] or weight["load"], weight["lever"] or weight["arm"]
        return f"{load.lower()}f*{lever.lower()}"
    if text.lower() in ALIASES and not is_unit(text):
        return ALIASES[text.lower()]
    # in a log no nanometre and no 1/60 Hz
    if text in ("nm", "1/min", "min^-1"):
        return ALIASES[text]
    if text in COUNTS:
        return "counts"
    if (rate := _PER_SECOND.fullmatch(text)) and not is_unit(text):
        of = unit_of_text(rate[1])
        return f"{of}/s" if of and of != "counts" and is_unit(f"{of}/s") else None
    return text if is_unit(text) and not text.isdigit() else None


def as_unit(text: str) -> str:
    """A unit that a person states: as it is, or as loggers and motors' sheets write it."""
    return text if is_unit(text) else unit_of_text(text) or text


def _suits(unit: str, quantity: str, axis: str) -> bool:
    if unit == "counts":
        return quantity == "position"
    if quantity == "force":
        return measures(unit, "force", axis) or unit in ("A", "mA", "V", "%")
    return measures(unit, quantity, axis)


@lru_cache(4096)  # a survey asks for each name many times
def words_of(name: str) -> tuple[str, ...]:
    """The words of a name in lower case, without accents: "Actual_Pos2 (deg)" -> actual, pos."""
    bare = _ADDRESS.sub(" ", bare_name(name))
    if not bare.strip() and (address := _ADDRESS.search(name)) is not None:
        bare = _OBJECTS.get(address[1].lower(), "")
    bare = re.sub(r"([a-z])([A-Z])", r"\1 \2", bare)
    letters = unicodedata.normalize("NFD", bare.lower())
    plain = "".join(c for c in letters if not "\u0300" <= c <= "\u036f")
    words = [w for w in re.split(r"[\W\d_]+", unicodedata.normalize("NFC", plain)) if w]
    return tuple(_join_terms(words))


def _join_terms(words: list[str]) -> list[str]:
    """The words, with terms of several words joined ("set point", "theta dot") or spelled out."""
    joined: list[str] = []
    for word in words:
        pair = (joined[-1] if joined else "", word)
        if pair in TERMS:
            joined[-1] = TERMS[pair]
        elif word in DERIVATIVES and joined and pair[0] in WORDS["position"]:
            joined[-1] = DERIVATIVES[word]
        else:
            joined.append(SHORT.get(word, word))
    return joined


@lru_cache(4096)
def likeness(name: str, quantity: str) -> float:
    """How much a column's name suggests a quantity: from 0 (not at all) to 1."""
    words = words_of(name)
    words = tuple(w for w in words if w != "x" or ALONG.isdisjoint(words))
    listed = WORDS[quantity]
    # a word that ends in "sensor", such as "Stromsensor", names no force
    may_end = quantity != "interaction_force"
    best = 0.0
    for word in words:
        for rank, known in enumerate(listed):
            # languages without spaces between words have a known word within a longer one
            exact = word == known or not known.isascii() and known in word
            # the last part of a compound names it: "Drehmoment", "Istwinkel"
            ends = may_end and len(known) > COMPOUND and word.endswith(known)
            if exact or ends or len(known) > _WHOLE_NAME and word.startswith(known):
                best = max(best, (1.0 if exact else 0.9) - 0.02 * min(rank, LAST_RANK))
    return best


def is_another_quantity(name: str) -> bool:
    """Whether a name or the unit in it stands for a pressure, a temperature or the like."""
    unit = (unfit_unit(name) or "").lower()
    return bool(OTHER_QUANTITIES.intersection(words_of(name))) or unit in OTHER_UNITS


def has_word(name: str, listed: Collection[str]) -> bool:
    """Whether a word of a name is one of those listed, or a compound of which it is the end.

    Languages without spaces between words have a known word within a longer one.
    """
    return any(
        word == known
        or not known.isascii()
        and known in word
        or len(known) > COMPOUND
        and word.endswith(known)
        for word in words_of(name)
        for known in listed
    )


def is_wanted(name: str) -> bool:
    """Whether a name says that its column is a reference or a command, not a measurement."""
    words = words_of(name)
    return any(word in WANTED or word.startswith(WANTED_BEGINNINGS) for word in words)

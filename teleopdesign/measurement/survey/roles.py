"""Which column has which role, by name, unit and relations: the assignment with the largest score.

    score = sum over the roles of ln odds(name and unit | role) - ln(part left by its relation)

The odds are a table (`roles.toml`). A relation is what physics requires of two columns: a velocity
is the derivative of its position, and a force balances inertia and friction along the motion. A
column that has nothing to do with the motion is explained but for a part e with a chance of e, so a
relation that leaves e is worth 1 / e.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Collection, Mapping
from functools import cache, lru_cache
from importlib.resources import files

from ...base.units import is_unit, measures
from ..column_names import (
    WANTED,
    bare_name,
    has_word,
    is_another_quantity,
    is_wanted,
    likeness,
    unit_in_name,
    words_of,
)
from ..doors._log import Log, bare_column
from .content import SURE_NAME, Choices, SurveyedColumn

Words = tuple[str, ...]

#: words for the two sides of a teleoperator, or of a device for both hands; letters of axes
_SIDES = (
    ("master", "slave"), ("leader", "follower"), ("local", "remote"), ("mtm", "psm"),
    ("left", "right"), ("links", "rechts"),
)  # fmt: skip
#: letters that are indices of sides where the log holds both; others, "q_d", tell kinds of values
_LETTERS = frozenset("mslfr")
#: the field of a struct or joint, or a whole name without one; and the numbers of axes ("J2_pos")
_STEM = re.compile(r"(?:^|[./])[^./]*$")
_NUMBERS = re.compile(r"\d+")
#: the letter of an axis in space as the last word of a name: "PosX", "force_y", "Torque z"
_SPACE = re.compile(r"(?:(?<=[a-z])[XYZ]|(?<=[_\s.-])[xyzXYZ])$")
#: words of names that tell columns apart by their number only
_COLUMNS = frozenset("column col channel chan ch var signal data value spalte kanal wert".split())
#: quantities whose words are no names of joints
_QUANTITIES = ("position", "velocity", "actuator_force", "interaction_force")

#: what words say -> the words, in the languages that `column_names` reads
SAYS: dict[str, tuple[str, ...]] = {
    kind: tuple(words.split())
    for kind, words in {
        # of a motor; "iq" makes the torque of a brushless one
        "current": "current curr cur strom courant corriente corrente i iq amps 電流 电流 전류 ток",
        # drives a motor against its speed
        "voltage": "voltage volts spannung uq vq",
        "torque": "torque moment drehmoment couple coppia force kraft fuerza forza tau "
        "トルク 力矩 扭矩 토크 момент сила",
        # a torque about an axis that turns
        "turning torque": "torque torques drehmoment moment couple coppia tau effort iq "
        "トルク 力矩 扭矩 토크 момент",
        # the motor side of a gear
        "motor side": "motor motors moteur モータ 电机 мотор",
        # parts that have a position, a speed and a force
        "part": "motor servo axis joint",
        # drives that report positions in turns; joints of limbs turn, also where they lift
        "drive in turns": "odrive moteus",
        "limb": "shoulder elbow wrist hip knee ankle",
        "angle": "angle winkel theta phi angulo angolo 角度 각도 угол",
        "turning": "q enc encoder joint motor servo rotor wheel shaft",
        # parts that slide, in names without an angle: "torso_lift_joint" is a joint that slides
        "sliding": "lift elevator slide slider prismatic linear rail carriage",
        # what a controller puts out, beside the words of a command
        "output": "u control ctrl controller output out input action pwm duty set "
        "commanded commands request requested",
        "counter": "enc encoder count counts counter ticks tick inc",
        # the clock of a microcontroller, and the time from one row to the next
        "clock": "tick systick clock uptime",
        "step of time": "dt timestep deltat δt",
        "acceleration": "acceleration accel acc beschleunigung acceleracion qdd ddq xdd ddx qddot "
        "ddtheta",
        # such as the error of a controller: "q_err", "Schleppfehler"
        "difference": "error err fehler abweichung deviation erreur ecart errore 误差 誤差 偏差 "
        "오차 ошибка",
        # a length or a place along a line
        "length": "position pos x weg displacement displ disp stroke slider verschiebung "
        "deplacement",
    }.items()
}

#: least part of a signal that a relation is taken to leave: what is nearer is as good, since
#: filters, delays and digits of a log leave a hundredth
LEAST_LEFT = 0.01
#: odds below which two columns, or a force and none, are equally likely: what names and relations
#: say is known no better
AS_LIKELY = 1.25


@cache
def _odds() -> Mapping[str, Mapping[str, float]]:
    text = (files(__package__) / "roles.toml").read_text(encoding="utf-8")
    return {
        role: {key: math.log(odds) if odds > 0 else -math.inf for key, odds in table.items()}
        for role, table in tomllib.loads(text).items()
    }


def score_of(role: str, column: SurveyedColumn, *, left: float = 1.0, **more: float) -> float:
    """The logarithm of the odds that a column has a role.

    left: part of a signal that the relation of the role leaves unexplained
    more: what relations to other columns say, 0 to 1, by keys of `roles.toml` with "_" for blanks
    """
    evidence = evidence_of(column, **more)
    logs = (odds * evidence[key] for key, odds in _odds()[role].items() if evidence.get(key))
    # of a column that is logged twice, the first: not the one that rounding favours
    return round(sum(logs) - math.log(min(max(left, LEAST_LEFT), 1.0)), 9)


def evidence_of(column: SurveyedColumn, **more: float) -> dict[str, float]:
    """What name and unit of a column, and `more`, say by the keys of `roles.toml`: 0 to 1."""
    name, kinds = column.name, kinds_of(column)
    quantities = ("time", "position", "velocity", "actuator_force", "interaction_force")
    evidence = {f"name of {_noun(q)}": likeness(name, q) for q in quantities}
    if says_only(name, "part"):
        evidence["name of an actuator force"] = 0.0
    # the load that a servo on a bus reports is that of its motor
    if evidence["name of an interaction force"] < SURE_NAME or column.code:
        evidence["name of an interaction force"] = 0.0
    evidence |= {
        f"unit of {_noun(q)}": float(q in kinds) for q in ("position", "velocity", "force")
    }
    evidence |= {word: float(says(name, word)) for word in ("difference", "voltage")}
    evidence |= {"wanted": is_wanted(name), "another quantity": is_no_position(column)}
    return evidence | {key.replace("_", " "): value for key, value in more.items()}


def is_nameless(column: SurveyedColumn) -> bool:
    """Whether neither unit nor name of a column says anything: "column 3", "CH2"."""
    kinds = ("position", "velocity", "actuator_force", "interaction_force")
    return column.unit is None and not any(likeness(column.name, kind) > 0 for kind in kinds)


def is_current(column: SurveyedColumn) -> bool:
    """Whether a column is a current, by its unit or, without a unit, by its name."""
    return column.unit in ("A", "mA") or column.unit is None and says(column.name, "current")


def is_named_force(column: SurveyedColumn) -> bool:
    """Whether unit or name are those of a force; "motor" is the name of what has one."""
    named = likeness(column.name, "actuator_force") > 0 and not says_only(column.name, "part")
    return named or is_unit_of(column.unit, "force")


def _noun(quantity: str) -> str:
    return f"{'an' if quantity[0] in 'ai' else 'a'} {quantity.replace('_', ' ')}"


def as_likely(scores: Mapping[str, float], best: str) -> list[str]:
    """The other columns whose score is hardly below that of the best one."""
    return [n for n, s in scores.items() if n != best and s > scores[best] - math.log(AS_LIKELY)]


def first_of(scores: Mapping[str, float]) -> str:
    """The first column than which none is clearly more likely."""
    best = max(scores, key=lambda n: scores[n])
    return next(n for n in scores if n in (best, *as_likely(scores, best)))


def is_no_position(column: SurveyedColumn) -> bool:
    """Whether a column is no position, by its unit or, without a unit, by its name.

    A potentiometer may be logged in mV, a valve in per cent of its stroke, and the last letters of
    a name may be no unit: "q_ms".
    """
    if is_unit_of(column.unit, "position") or is_unit_of(column.unit, "time"):
        return False
    named = likeness(column.name, "position")
    if column.unit is not None and is_unit(column.unit):
        return not (named >= SURE_NAME and column.unit in ("mV", "%"))
    others = ("velocity", "actuator_force", "interaction_force")
    no_position = max(likeness(column.name, other) for other in others) >= SURE_NAME
    no_position = no_position and not says_only(column.name, "part")
    return named == 0 and (no_position or is_another_quantity(column.name))


def says(name: str, *kinds: str) -> bool:
    """Whether a name contains a word that says one of these: "Motorstrom" says "current"."""
    return any(has_word(name, SAYS[kind]) for kind in kinds)


def says_only(name: str, kind: str) -> bool:
    """Whether a name has no other words: "motor" tells a part, and no quantity of it."""
    return bool(words_of(name)) and set(SAYS[kind]).issuperset(words_of(name))


def unit_in_log(name: str, log: Log, choices: Choices) -> str | None:
    """The unit of a column: as the user or the file states it, or at the end of its name.

    One letter is a unit where the words before it name a length: "position_m" is in metres. Beside
    "position_s" it is an index, as of a master.
    """
    if stated := choices.units.get(name) or log.units.get(name):
        return stated
    unit = unit_in_name(name)
    stem, _, letter = bare_column(name).rpartition("_")
    if unit is not None or letter != "m" or not says(stem, "length"):
        return unit
    index = re.compile(re.escape(stem) + r"_[a-z]$", re.I)
    return None if any(index.match(bare_column(n)) for n in log.names if n != name) else "m"


def is_unit_of(unit: str | None, quantity: str) -> bool:
    """Whether a unit fits a quantity on either axis; for a force, also A, mA, V and %."""
    if unit is None:
        return False
    if unit == "counts":
        return quantity == "position"
    if quantity == "force" and is_unit(unit) and unit in ("A", "mA", "V", "%"):
        return True
    if quantity == "time":
        return unit != "counts" and is_unit(unit) and measures(unit, "time")
    return any(measures(unit, quantity, axis) for axis in ("prismatic", "revolute"))


def kinds_of(column: SurveyedColumn) -> list[str]:
    """The quantities that a column's unit fits; of parts in per cent the name says which."""
    if column.unit == "%" and likeness(column.name, "position") >= SURE_NAME:
        return []
    return [q for q in ("position", "velocity", "force") if is_unit_of(column.unit, q)]


def stand_together(one: str, other: str) -> bool:
    """Whether two columns are fields of one struct, or of one joint in a message."""
    stems = {_STEM.sub("", name) for name in (one, other)}
    if stems != {""}:
        return len(stems) == 1
    numbers = {_axis_numbers(name) for name in (one, other)}
    return len(numbers) == 1 and () not in numbers


def _axis_numbers(name: str) -> tuple[str, ...]:
    """Numbers in a name, "J2_pos" -> 2, or its letter, "PosX" -> x: such numbers count axes.

    Where the name says no more, "column 2", they count columns.
    """
    bare = bare_name(name)
    if _COLUMNS.issuperset(words_of(_SPACE.sub("", bare))):
        return ()
    return (*_NUMBERS.findall(bare), *map(str.lower, _SPACE.findall(bare)))


def of_another_axis(one: str, other: str, names: Collection[str] = ()) -> bool:
    """Whether two columns belong to two axes: "J1_current", "J2_angle"; "slave_pos", "master_cmd".

    names: all columns of the log. Another word or letter calls a joint or a side only where the log
        holds each of the two columns with that of the other, too: "q_m", "q_s", "tau_m", "tau_s"
    """
    numbers = {_axis_numbers(name) for name in (one, other)}
    if len(numbers) == 2 and () not in numbers:
        return True
    first, second = (words_of(name) for name in (one, other))
    for pair in _SIDES:
        sides = [{side for side in pair if side in words} for words in (first, second)]
        if all(len(side) == 1 for side in sides):
            return sides[0] != sides[1]
    (label, quantity), (label_2, quantity_2) = _split(first), _split(second)
    if not label or not label_2 or label == label_2:
        return False
    splits = {_split(words_of(name)) for name in names}
    both, both_2 = ({q for of, q in splits if of == one} for one in (label, label_2))
    return {quantity, quantity_2} <= both & both_2 and len(both & both_2) > 1


@lru_cache(maxsize=4096)
def _split(words: Words) -> tuple[Words, Words]:
    """The words that may call a joint, "hip", or a side, "m", and those of a quantity."""
    tells = {
        w for w in words if w in WANTED or any(likeness(w, q) >= SURE_NAME for q in _QUANTITIES)
    }
    called = [w in _LETTERS if len(w) == 1 else w not in tells for w in words]
    pairs = list(zip(words, called, strict=True))
    return tuple(w for w, is_label in pairs if is_label), tuple(w for w, is_l in pairs if not is_l)

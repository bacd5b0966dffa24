"""Which column has which role: the assignment with the largest score.

    score = sum over the roles of ln odds(name and unit | role) - ln(part left by its relation)

The odds are a table (`roles.toml`). A relation is what physics requires of two columns: a velocity
is the derivative of its position, and a force balances inertia and friction along the motion. A
column that has nothing to do with the motion is explained but for a part e with a chance of e, so a
relation that leaves e is worth 1 / e.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from ...base.units import is_unit
from ..column_names import is_another_quantity, is_wanted, likeness
from .content import SURE_NAME, SurveyedColumn, is_unit_of, kinds_of
from .words import says, says_only

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

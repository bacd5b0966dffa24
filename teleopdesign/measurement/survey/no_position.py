"""What a message says of a log in which no column can be a position, and what to do about it."""

from __future__ import annotations

from collections.abc import Mapping

from ...base.errors import ExperimentError
from ..column_names import is_wanted, likeness
from ..doors._log import join_names
from .content import (
    OF_SENSORS,
    Survey,
    SurveyedColumn,
    is_unit_of,
    names_at_rest,
    reasons,
)
from .derivative import is_velocity, overflow_of


def has_only_speeds(column: SurveyedColumn, moving: Mapping[str, SurveyedColumn]) -> bool:
    """Whether a log holds a measured velocity, and a column of which nothing says it is a position.

    column: no velocity is its derivative, and it follows no set point
    The velocity beside a position is its derivative. A velocity of no column's motion is that of a
    body whose position is not in the log.
    """
    if likeness(column.name, "position") > 0.0 or is_unit_of(column.unit, "position"):
        return False
    return any(is_velocity(c) and not is_wanted(n) for n, c in moving.items() if n != column.name)


def error_without_position(
    survey: Survey, moving: Mapping[str, SurveyedColumn], file: str, nearest: str = ""
) -> ExperimentError:
    """The error for a log without a position; moving: the columns that change, by name.

    nearest: a column whose name leaves open what it is, and of which no velocity is the derivative
    """
    why = "no column changes without being a force or velocity by unit or name"
    how = f"{_integral_of(moving)}{_named_as_force(moving)}"
    if nearest:
        why = f"{nearest!r} is none by name or unit, and no velocity is its derivative"
        how = f"; if it is one: --position {nearest!r}{how.replace(';', '; else', 1)}"
    return ExperimentError(
        f"{file}: found no position: {why}, among {join_names(survey.columns) or 'none'}"
        f"{_names_of_constants(survey)}{how}{reasons(survey.unread)}"
    )


def _names_of_constants(survey: Survey) -> str:
    """Which columns hold one value throughout, for a message; "" where all change."""
    names = names_at_rest(survey)
    return f" ({join_names(names)} not changing)" if names else ""


def _integral_of(moving: Mapping[str, SurveyedColumn]) -> str:
    """What to do with a log of velocities, as the end of a message; "" without a velocity.

    The integral of a desired velocity would be a set point.
    """
    names = [name for name, column in moving.items() if is_velocity(column)]
    names.sort(key=is_wanted)
    if not names:
        return ""
    leap = overflow_of(moving[names[0]].values)
    first = f" (first undo its leaps of {leap:.3g}, as of a number that wraps)" if leap else ""
    return f"; add a column with the integral of {names[0]!r}{first}"


def _named_as_force(moving: Mapping[str, SurveyedColumn]) -> str:
    """How to choose a column that its name makes a force, for a message; not beside a velocity.

    A converter logs each of its inputs in V, whatever the sensor measures.
    """
    if any(map(is_velocity, moving.values())):
        return ""
    unsure = (n for n, c in moving.items() if c.unit is None or c.unit in OF_SENSORS)
    names = [n for n in unsure if likeness(n, "actuator_force") == 0.0]
    if not names:
        return ""
    volts = moving[names[0]].unit
    more = f", then `scale` in experiment.toml, per {volts}" if volts else ""
    return f"; if {names[0]!r} is the position: --position {names[0]!r}{more}"

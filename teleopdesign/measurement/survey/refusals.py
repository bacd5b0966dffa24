"""What a message says of a log in which no position or no force is certain, and what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...base.errors import ExperimentError
from ..column_names import is_wanted, likeness
from ..doors._log import join_names
from ..first_guess import band_of_fit, inner_rows
from .content import (
    OF_SENSORS,
    Survey,
    SurveyedColumn,
    columns_in_use,
    is_unit_of,
    moves,
    reasons,
    rises,
    sample_time_of,
)
from .derivative import is_velocity

#: independent values of a low-passed force, from which an explanation is none by chance: the four
#: columns of a motion explain any four values, and half of the squares of eight
FEWEST_VALUES = 8.0


def tells_forces(survey: Survey) -> bool:
    """Whether the rows of a log are enough to show which force its motion explains."""
    h = sample_time_of(survey)
    seconds = (len(survey.time) - 2 * inner_rows(h).start) * h
    return bool(2.0 * band_of_fit(h) * seconds >= FEWEST_VALUES)


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
    how = _how_to_choose_position(moving)
    if nearest:
        why = f"{nearest!r} is none by name or unit, and no velocity is its derivative"
        how = f"; if it is one: --position {nearest!r}{how.replace(';', '; else', 1)}"
    still = [name for name, column in survey.columns.items() if not moves(column)]
    constant = f" ({join_names(still)} not changing)" if still else ""
    return ExperimentError(
        f"{file}: found no position: {why}, among {join_names(survey.columns) or 'none'}"
        f"{constant}{how}{reasons(survey.unread)}"
    )


def _how_to_choose_position(moving: Mapping[str, SurveyedColumn]) -> str:
    """What to do with a log of velocities, or of inputs in V whatever their sensors measure.

    The integral of a desired velocity would be a set point.
    """
    speeds = sorted((n for n, c in moving.items() if is_velocity(c)), key=is_wanted)
    if speeds:
        return f"; add a column with the integral of {speeds[0]!r}"
    unsure = (n for n, c in moving.items() if c.unit is None or c.unit in OF_SENSORS)
    names = [n for n in unsure if likeness(n, "actuator_force") == 0.0]
    if not names:
        return ""
    volts = moving[names[0]].unit
    more = f", then `scale` in experiment.toml, per {volts}" if volts else ""
    return f"; if {names[0]!r} is the position: --position {names[0]!r}{more}"


def error_without_force(survey: Survey, file: str, velocity: str | None) -> ExperimentError:
    """The error for a log without a column that could be a force."""
    position = survey.channels["position"]["column"]
    return ExperimentError(
        f"{file}: found no column that could be a force beside {position!r}, "
        f"found {join_names(survey.columns)}{explain_other_roles(survey, velocity)}"
        f"{_constant_columns(survey)}{reasons(survey.unread)}"
    )


def error_of_chance(
    survey: Survey, file: str, best: tuple[str, float], others: str
) -> ExperimentError:
    """The error where no name tells the force, and the motion shows none.

    best: the most likely column, and the part of it that the motion explains
    others: all columns that may be the force
    """
    name, share = best
    what = f"the motion explains {max(share, 0.0):.0%} of {name!r}"
    if not tells_forces(survey):
        what = f"{len(survey.time)} rows are too few to show which column moves the body"
    return ExperimentError(
        f"{file}: found no force: no column has the name or unit of a force, and {what}; "
        f"--force COLUMN selects one of {others}"
    )


def explain_other_roles(survey: Survey, velocity: str | None) -> str:
    """Which columns without a unit, taken for something else, may be the force, for a message."""
    others = {n: why for n, why in survey.relations.items() if survey.columns[n].unit is None}
    if velocity is not None and not is_velocity(survey.columns[velocity]):
        position = survey.channels["position"]["column"]
        others = {velocity: f"a velocity: the derivative of {position!r}", **others}
    if not others:
        return ""
    listed = "".join(f"; {n!r} is taken for {why}" for n, why in [*others.items()][:3])
    return f"{listed}; --force {next(iter(others))!r} overrules this"


def _constant_columns(survey: Survey) -> str:
    """How to choose a command that is constant in a log, or a ramp, for a message; "": none is.

    Each of several logs may hold another constant command.
    """
    free = {n: c for n, c in survey.columns.items() if n not in columns_in_use(survey)}
    kinds: tuple[tuple[Sequence[str], str, str], ...] = (
        ([n for n, c in free.items() if not moves(c)], "does not change here", "such a command"),
        ([n for n, c in free.items() if moves(c) and rises(c.readings)], "only rises", "a ramp"),
    )
    return "".join(
        f"; {join_names(names)} {what}: --force {names[-1]!r} chooses {command}"
        for names, what, command in kinds
        if names
    )

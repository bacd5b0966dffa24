"""What a message says of a column that is not used, and of a log without position or force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...base.errors import ExperimentError
from ..column_names import is_another_quantity, is_wanted, likeness
from ..doors._log import Log, join_names
from ..encoder import Array
from ..first_guess import band_of_fit, inner_rows
from .content import (
    OF_SENSORS,
    Survey,
    SurveyedColumn,
    columns_in_use,
    moves,
    reasons,
    rises,
    sample_time_of,
)
from .derivative import DERIVATIVE, is_no_velocity, is_velocity, rate_agreement, unwrap_column
from .roles import is_unit_of, of_another_axis, says

#: independent values of a low-passed force, from which an explanation is none by chance: the four
#: columns of a motion explain any four values, and half of the squares of eight
FEWEST_VALUES = 8.0


def tells_forces(survey: Survey) -> bool:
    """Whether the rows of a log are enough to show which force its motion explains."""
    h = sample_time_of(survey)
    seconds = (len(survey.time) - 2 * inner_rows(h).start) * h
    return bool(2.0 * band_of_fit(h) * seconds >= FEWEST_VALUES)


def error_without_position(
    survey: Survey,
    moving: Mapping[str, SurveyedColumn],
    file: str,
    nearest: str = "",
    acceleration: str = "",
) -> ExperimentError:
    """The error for a log without a position; moving: the columns that change, by name.

    nearest: a column whose name leaves open what it is, and of which no velocity is the derivative
    acceleration: the column beside it that is like its force or its acceleration
    """
    why = "no column changes without being a force or velocity by unit or name"
    speeds = sorted((n for n, c in moving.items() if is_velocity(c)), key=is_wanted)
    # an input of a logger in V may be any sensor; the integral of a wanted velocity is a set point
    unsure = [
        n
        for n, c in moving.items()
        if (c.unit is None or c.unit in OF_SENSORS) and likeness(n, "actuator_force") == 0.0
    ]
    how = ""
    if nearest:
        why = f"{nearest!r} is none by name or unit, and no velocity is its derivative"
        if acceleration:
            pair = f"{nearest!r} and {acceleration!r}"
            why = f"{pair} are like a force and the acceleration that it causes"
        how = f"; if it is one: --position {nearest!r}"
    if speeds:
        how += f"; {'else ' * bool(nearest)}add a column with the integral of {speeds[0]!r}"
    elif unsure and not nearest:
        volts = moving[unsure[0]].unit
        more = f", then `scale` in experiment.toml, per {volts}" if volts else ""
        how = f"; if {unsure[0]!r} is the position: --position {unsure[0]!r}{more}"
    still = [name for name, column in survey.columns.items() if not moves(column)]
    constant = f" ({join_names(still)} not changing)" if still else ""
    return ExperimentError(
        f"{file}: found no position: {why}, among {join_names(survey.columns) or 'none'}"
        f"{constant}{how}{reasons(survey.unread)}"
    )


def error_without_force(
    survey: Survey, file: str, velocity: str | None, best: str = ""
) -> ExperimentError:
    """The error for a log without a force; best: the likeliest column, without the name of one."""
    position = survey.channels["position"]["column"]
    others = {n: why for n, why in survey.relations.items() if survey.columns[n].unit is None}
    if velocity is not None and not is_velocity(survey.columns[velocity]):
        others = {velocity: f"a velocity: the derivative of {position!r}", **others}
    listed = "".join(f"; {n!r} is taken for {why}" for n, why in [*others.items()][:3])
    if others:
        listed += f"; --force {next(iter(others))!r} overrules this"
    if not best:
        return ExperimentError(
            f"{file}: found no column that could be a force beside {position!r}, found "
            f"{join_names(survey.columns)}{listed}{reasons(survey.unread)}"
        )
    what = (
        f"the motion explains {survey.explained[best]:.0%} of {best!r} beyond the place, which a "
        "second position or a spring follows as well"
    )
    if not tells_forces(survey):
        what = f"{len(survey.time)} rows are too few to show which column moves the body"
    return ExperimentError(
        f"{file}: found no force: no column has the name or unit of a force, and {what}; "
        f"--force COLUMN selects one of {join_names(survey.explained)}{listed}"
    )


def unused_columns(log: Log, raw: Mapping[str, Array], survey: Survey) -> dict[str, str]:
    """Column -> reason why it is in no channel, in the order of the log.

    raw: the columns of numbers, by name
    """
    used = columns_in_use(survey)
    used |= {log.clocks[name] for name in used if name in log.clocks}
    left = [name for name in dict.fromkeys(log.names) if name not in used]
    return {name: _explain_unused(name, log, raw, survey) for name in left}


def _explain_unused(name: str, log: Log, raw: Mapping[str, Array], survey: Survey) -> str:
    if name not in raw:
        why = survey.unread.get(name, "")
        return why if why.startswith("one value") else f"holds no numbers{f' ({why})' * bool(why)}"
    if name in log.clocks.values():
        return "stamps of a topic that is not used"
    column = survey.columns.get(name)
    if column is None:
        return f"has {len(raw[name])} rows, another number than the time"
    if not moves(column):
        return "does not change"
    if rises(column.readings):
        return "only rises, as a second clock or a counter does"
    if survey.is_stated:
        return "not among the columns that are stated"
    position = survey.channels["position"]["column"]
    if of_another_axis(name, position, survey.columns):
        return f"of another axis than {position!r}: --position chooses the axis"
    is_force = is_unit_of(column.unit, "force")
    if is_another_quantity(name) and not is_force:
        return (
            "its name is not that of a position, velocity or force; for a pressure that acts on "
            "the body: "
            f'interaction_force = {{ column = "{name}", unit = "N", scale = N per unit of it }}'
        )
    if is_wanted(name) and not is_force:
        return "a desired value, not a measured one"
    if says(name, "difference"):
        return "by its name a difference, such as the error of a controller"
    return survey.relations.get(name) or _explain_no_force(column, survey)


def _explain_no_force(column: SurveyedColumn, survey: Survey) -> str:
    """What a column is that might be a force: a velocity, or explained too little."""
    name, position = column.name, survey.channels["position"]["column"]
    x = survey.columns[position].values
    x = unwrap_column(x)
    # a voltage is nearly in proportion to the speed
    may_agree = not is_no_velocity(column)
    if may_agree and rate_agreement(x, column.values, sample_time_of(survey)) > DERIVATIVE:
        how = "" if column.unit else f"; --unit {name + '=UNIT'!r} states its unit"
        return f"a velocity of {position!r}, which is computed from the position{how}"
    force = survey.channels["actuator_force"]["column"]
    share, best = (survey.explained.get(n) for n in (name, force))
    beside = "" if best is None else f", and {best:.0%} of {force!r}"
    explained = "" if share is None else f": the motion explains {share:.0%} of it{beside}"
    return f"no channel beside {force!r}{explained}"


def explain_ambiguity(column: str, others: Sequence[str], what: str) -> str:
    """The reason why the choice of a column is a guess: other columns suit as well."""
    named = join_names(map(repr, others), most=3)
    return f"{column!r} is read as {what}: {named} may be {what} as well"

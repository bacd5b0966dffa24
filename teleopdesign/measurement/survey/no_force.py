"""What a message says of a log in which no column is a force for sure, and what to do about it."""

from __future__ import annotations

from collections.abc import Sequence

from ...base.errors import ExperimentError
from ..doors._log import join_names
from ..first_guess import band_of_fit, inner_rows
from .content import Survey, columns_in_use, moves, names_at_rest, reasons, rises, sample_time_of
from .derivative import is_velocity, unwrap_column, wrap_of
from .force_candidates import is_set_point, is_speed

#: independent values of a low-passed force, from which an explanation is none by chance: the four
#: columns of a motion explain any four values, and half of the squares of eight
FEWEST_VALUES = 8.0


def tells_forces(survey: Survey) -> bool:
    """Whether the rows of a log are enough to show which force its motion explains."""
    h = sample_time_of(survey)
    seconds = (len(survey.time) - 2 * inner_rows(h).start) * h
    return bool(2.0 * band_of_fit(h) * seconds >= FEWEST_VALUES)


def error_without_force(survey: Survey, file: str, beside: str) -> ExperimentError:
    """The error for a log without a column that could be a force.

    beside: which other column may be one
    """
    return ExperimentError(
        f"{file}: found no column that could be a force beside "
        f"{survey.channels['position']['column']!r}, "
        f"found {join_names(survey.columns)}{beside}{_constant_columns(survey)}"
        f"{reasons(survey.unread)}"
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


def error_of_place(survey: Survey, file: str, name: str) -> ExperimentError:
    """The error where the likeliest column without the name of a force follows the position."""
    position = survey.channels["position"]["column"]
    return ExperimentError(
        f"{file}: found no force: {name!r} follows {position!r} as a second position or a spring "
        f"does, and its name states no force; --force {name!r} if it is one"
    )


def taken_for_something_else(survey: Survey, velocity: str | None) -> str:
    """Which columns, taken for velocities or set points, may be the force, for a message."""
    used = columns_in_use(survey)
    others = [c for n, c in survey.columns.items() if n not in used and moves(c)]
    names = [c.name for c in others if is_speed(c, survey, velocity)]
    if velocity is not None and not is_velocity(survey.columns[velocity]):
        names = [velocity, *(n for n in names if n != velocity)]
    position = survey.channels["position"]["column"]
    x = survey.columns[position].values
    x = unwrap_column(x, wrap_of(x))
    wanted = [c.name for c in others if is_set_point(c, x)]
    return _explain_overruling(names, "a velocity") + _explain_overruling(
        wanted, f"a set point of {position!r}"
    )


def _explain_overruling(names: Sequence[str], kind: str) -> str:
    """How to choose columns as a force that were taken for something else; "": there are none."""
    if not names:
        return ""
    what = "are" if len(names) > 1 else "is"
    return f"; {join_names(names)} {what} taken for {kind}, --force {names[0]!r} overrules this"


def _constant_columns(survey: Survey) -> str:
    """How to choose a command that is constant in a log, or a ramp, for a message; "": none is.

    Each of several logs may hold another constant command.
    """
    names = names_at_rest(survey)
    rising = [n for n, c in survey.columns.items() if rises(c.readings)]
    rising = [n for n in rising if n not in columns_in_use(survey)]
    text = ""
    if names:
        which = f"{join_names(names)} {'does' if len(names) == 1 else 'do'} not change here"
        text += f"; {which}: --force {names[0]!r} chooses such a command"
    if rising:
        which = f"{join_names(rising)} only {'rises' if len(rising) == 1 else 'rise'}"
        text += f"; {which}: --force {rising[-1]!r} chooses a ramp"
    return text

"""What each column of a log is beside its position, and so why it is in no channel.

A column is no force where one of the relations of `relations_of` holds: it is the position or its
velocity once more, a set point, or the motion of another body. The same sentence says why the
column is not used, and is given where no force is left. A force that is left out without a remark
would look like physics that the model lacks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from ...base.units import is_unit
from ..column_names import is_another_quantity, is_wanted, likeness, words_of
from ..doors._log import Log
from ..encoder import SURELY, Array
from ..first_guess import least_squares, stretch_of
from ..law_of_readings import is_copy
from .axes import of_another_axis
from .content import (
    SURE_NAME,
    Survey,
    SurveyedColumn,
    columns_in_use,
    is_unit_of,
    moves,
    rises,
    sample_time_of,
)
from .derivative import (
    DERIVATIVE,
    derivative_factor,
    is_no_velocity,
    is_velocity,
    may_be_ramp,
    rate_agreement,
    unwrap_column,
    wrap_of,
)
from .roles import LEAST_LEFT, is_nameless
from .set_point import has_numbers_of, is_sent_to_places, may_be_set_point
from .words import says

#: correlation from which one column is the derivative of another to its digits, as of a planned
#: path: friction of 1 % of a force lowers it below
EXACT = 0.9999


def relations_of(
    survey: Survey, position: str, velocity: str | None, x: Array
) -> Iterator[tuple[str, str]]:
    """Columns that are no force beside a position x (n,), each with what it is, as a noun phrase.

    velocity: its column, if there is one.  A column in the unit of a force has no relation
    """
    speed = None if velocity is None else survey.columns[velocity].values
    planned = dict(_planned_motions(survey, sample_time_of(survey)))
    for name, column in survey.columns.items():
        used = name in (position, velocity) or name in columns_in_use(survey)
        if used or not moves(column) or is_unit_of(column.unit, "force"):
            continue
        what = _relation(column, position, x, speed) or planned.get(name)
        if what is not None:
            yield name, what


def _relation(column: SurveyedColumn, position: str, x: Array, speed: Array | None) -> str | None:
    """What a column is beside a position x (n,) and its velocity; None: it may be a force."""
    name, values = column.name, column.values
    forces = max(likeness(name, f"{whose}_force") for whose in ("actuator", "interaction"))
    if column.unit and is_unit(column.unit):
        if is_unit_of(column.unit, "velocity"):
            return f"a velocity, but not that of {position!r}"
        beside = is_unit_of(column.unit, "position")
        return f"a position beside {position!r}" if beside else f"a column in {column.unit}"
    if may_be_set_point(column) and has_numbers_of(values, x):
        return f"a set point, or a reading once more: it has the numbers of {position!r}"
    if is_sent_to_places(x, column):
        return f"a set point: {position!r} rests at a place of its own for each of its values"
    if forces == 0 and is_copy(values, x):
        return f"{position!r} times a constant plus a constant: another unit, or a control error"
    if forces == 0 and speed is not None and is_copy(values, speed):
        return f"the velocity of {position!r} once more: another unit, or a control error"
    # a symbol is no word: "v" may be a voltage as well
    if is_velocity(column) and any(
        len(w) > 1 and likeness(w, "velocity") >= SURE_NAME for w in words_of(name)
    ):
        return "a velocity by its name"
    return "an acceleration by its name" if says(name, "acceleration") else None


def left_in_turn(force: Array, position: Array, sample_time: float) -> tuple[float, float]:
    """Part of a force (n,) that its place leaves, and part of that which the motion leaves.

    Place: a cubic of the position, which a spring, a weight or a second reading of the position
    follows. Motion: inertia, friction and damping beside it. Where the place leaves less than a
    hundredth, friction must be certain, and brake where the place pulls back: a reading that is
    late has friction of the other sign.
    """
    stretch = stretch_of((force, position), position, sample_time)
    if stretch is None:
        return 1.0, 1.0
    columns, (target, place) = stretch
    place = (place - place.mean()) / max(float(np.ptp(place)), np.finfo(float).tiny)
    powers = np.stack([columns[3], place, place**2, place**3])
    of_place = least_squares(powers, target, sample_time)
    of_all = least_squares(np.vstack([columns[:3], powers]), target, sample_time)
    whole = float(np.var(target))
    if not of_place[2] * whole > 0.0:
        return 1.0, 1.0
    (factors, errors, left), beside = of_all, of_place[2]
    brakes = factors[1:3] * np.sign(target @ place) > SURELY * errors[1:3]
    share = beside**2 / whole
    is_place = share < LEAST_LEFT and not brakes.any()
    return min(share, 1.0), 1.0 if is_place else min(left / beside, 1.0) ** 2


def causes_acceleration(place: Array, column: Array, sample_time: float) -> bool:
    """Whether a column (n,) is the acceleration that another one causes as a force.

        place = m column + c sgn(v) + b v + k,   v: the integral of the column

    A torque and an acceleration imitate a position and its force: each is in proportion to the
    other but for friction. The relation that leaves less holds, if its inertia is surely positive.
    """
    rows = np.arange(len(column))
    speed = sample_time * np.cumsum(column - column.mean())
    # the speed at the first row, and the offset of a sensor, are not known
    speed -= np.polynomial.Polynomial.fit(rows, speed, 1)(rows)
    stretch = stretch_of((place, column, np.sign(speed), speed), place, sample_time)
    if stretch is None:
        return False
    (*_, one), (target, *caused) = stretch
    factors, errors, left = least_squares(np.stack([*caused, one]), target, sample_time)
    by_motion = math.prod(left_in_turn(column, place, sample_time))
    return bool(factors[0] > SURELY * errors[0] and left**2 < np.var(target) * by_motion)


def possible_forces(survey: Survey, *used: str | None) -> dict[str, SurveyedColumn]:
    """The columns that may be a force: those of no other relation to the position."""
    return {
        name: column
        for name, column in survey.columns.items()
        if name not in (*used, *survey.relations) and name not in columns_in_use(survey)
        if moves(column) and (not rises(column.readings) or may_be_ramp(column))
    }


def _planned_motions(survey: Survey, h: float) -> Iterator[tuple[str, str]]:
    """Columns without names that are position, velocity and acceleration of a planned path.

    Each is exactly the derivative of the one before. Two such columns alone tell less: the friction
    of a body that goes to and fro at one speed is the derivative of its position, too.
    """
    columns = {n: c.values for n, c in survey.columns.items() if moves(c) and is_nameless(c)}
    rates = {
        one: {n: derivative_factor(y, v, h)[1] for n, v in columns.items() if n != one}
        for one, y in columns.items()
    }
    exact = {one: [n for n, agree in of.items() if agree > EXACT] for one, of in rates.items()}
    for one, after in exact.items():
        for two, three in ((b, c) for b in after for c in exact[b] if c != one):
            for name in (one, two, three):
                yield name, "a motion that was planned: an exact derivative, or integral, of others"


def unused_columns(log: Log, raw: Mapping[str, Array], survey: Survey) -> dict[str, str]:
    """Column -> reason why it is in no channel, in the order of the log.

    raw: the columns of numbers, by name
    """
    used = columns_in_use(survey)
    used |= {log.clocks[name] for name in used if name in log.clocks}
    left = [name for name in dict.fromkeys(log.names) if name not in used]
    return {name: _explain_unused(name, log, raw, survey) for name in left}


def _explain_unused(name: str, log: Log, raw: Mapping[str, Array], survey: Survey) -> str:
    if (count := log.names.count(name)) > 1:
        return f"{count} columns have this name"
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
    x = unwrap_column(x, wrap_of(x))
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

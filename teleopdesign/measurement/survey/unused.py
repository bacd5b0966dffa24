"""Which columns of a log are in no channel, and why.

A force that is left out without a remark would look like physics that the model lacks.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...base.units import is_unit
from ..column_names import is_another_quantity, is_difference, is_wanted, likeness
from ..doors._log import Log
from ..law_of_readings import is_copy
from .axes import of_another_axis
from .content import (
    SURE_NAME,
    Array,
    Survey,
    SurveyedColumn,
    columns_in_use,
    is_unit_of,
    moves,
    rises,
    sample_time_of,
)
from .copies import repeats_mostly
from .derivative import (
    DERIVATIVE,
    is_acceleration,
    is_no_velocity,
    rate_agreement,
    unwrap_column,
    wrap_of,
)
from .force_candidates import is_speed, place_of_steps, places_of_steps
from .set_point import follows, has_numbers_of, is_sent_to_places, may_be_set_point


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
        why = survey.unread.get(name)
        if why is not None and why.startswith("one value"):
            return why
        return f"holds no numbers ({why})" if why else "holds no numbers"
    if name in log.clocks.values():
        return "stamps of a topic that is not used"
    column = survey.columns.get(name)
    if column is None:
        return f"has {len(raw[name])} rows, another number than the time"
    if not moves(column):
        return "does not change"
    if rises(column.readings):
        return "only rises, as a second clock or a counter does"
    return _explain_no_channel(column, survey)


def _explain_no_channel(column: SurveyedColumn, survey: Survey) -> str:
    """Why a signal that changes is taken for neither position, velocity nor force."""
    name, unit, position = column.name, column.unit, survey.channels["position"]["column"]
    if of_another_axis(name, position, survey.columns):
        return f"of another axis than {position!r}: --position chooses the axis"
    kinds = [q for q in ("position", "velocity", "force") if is_unit_of(unit, q)]
    if unit is not None and is_unit(unit) and not kinds:
        return f"in {unit}: no position, velocity or force"
    if is_another_quantity(name) and not kinds:
        return (
            "its name is not that of a position, velocity or force; for a pressure that acts on "
            "the body: "
            f'interaction_force = {{ column = "{name}", unit = "N", scale = N per unit of it }}'
        )
    if is_wanted(name) and "force" not in kinds:
        return "a desired value, not a measured one"
    if is_difference(name):
        return "by its name a difference, such as the error of a controller"
    x = survey.columns[position].values
    jump = wrap_of(x)
    if may_be_set_point(column) and follows(unwrap_column(x, jump), column.values):
        return f"a set point: {position!r} follows it"
    agree = rate_agreement(unwrap_column(x, jump), column.values, sample_time_of(survey))
    if is_no_velocity(column):
        agree = 0.0  # a voltage is nearly in proportion to the speed
    if agree > DERIVATIVE and "velocity" in survey.channels:
        return f"a second velocity for {position!r}"
    if agree > DERIVATIVE:
        how = (
            ""
            if unit
            else f"; its unit is not known: state the unit with --unit {name + '=UNIT'!r}"
        )
        return f"the velocity of {position!r}, which is computed from the position{how}"
    for quantity, why in (
        ("position", f"a position beside {position!r}"),
        ("velocity", f"a velocity, but not that of {position!r}"),
    ):
        if quantity in kinds or not kinds and likeness(name, quantity) >= SURE_NAME:
            return why
    if may_be_set_point(column) and has_numbers_of(column.values, unwrap_column(x, jump)):
        return f"has the numbers of {position!r}: a set point, or the same reading once more"
    if is_sent_to_places(unwrap_column(x, jump), column):
        return f"a set point: {position!r} rests at a place of its own for each of its values"
    h = sample_time_of(survey)
    rate = np.gradient(unwrap_column(x, jump), h)
    if name not in survey.explained and is_acceleration(column, rate, h):
        return f"an acceleration of {position!r}"
    if is_speed(column, survey) and name not in survey.explained:
        place = place_of_steps(column, survey)
        by = "its name" if place is None else f"its signs, those of the steps of {place!r}"
        return f"a velocity by {by}, and no force"
    if (of_another := _explain_other_body(name, survey)) and name not in survey.explained:
        return of_another
    if name not in survey.explained and is_copy(column.values, unwrap_column(x, jump)):
        return f"{position!r} times a constant plus a constant: another unit, or a control error"
    again = _set_point_again(column, survey, unwrap_column(x, jump))
    if again is not None and name not in survey.explained:
        return f"the set point {again!r} in another unit, or with the other sign"
    return _explain_no_force(name, survey)


def _explain_other_body(name: str, survey: Survey) -> str | None:
    """Which position or velocity of another body a column without a name is; None: it is none."""
    if speed := places_of_steps(survey).get(name):
        return f"another position: {speed!r} has the signs of its steps"
    if name in survey.motions:
        return f"the position of another body: {survey.motions[name]!r} is its derivative"
    place = next((place for place, speed in survey.motions.items() if speed == name), None)
    return None if place is None else f"the velocity of another body: the derivative of {place!r}"


def _set_point_again(column: SurveyedColumn, survey: Survey, x: Array) -> str | None:
    """The set point of a position x (n,) that a column repeats; None: it repeats none."""
    if not may_be_set_point(column):
        return None
    apart = {column.name, survey.channels["position"]["column"]}
    others = (c for n, c in survey.columns.items() if n not in apart and may_be_set_point(c))
    names = (
        c.name
        for c in others
        if moves(c) and has_numbers_of(c.values, x) and repeats_mostly(column.values, c.values)
    )
    return next(names, None)


def _explain_no_force(name: str, survey: Survey) -> str:
    """How much of a column the motion explains, compared with the chosen force."""
    force = survey.channels["actuator_force"]["column"]
    share, best = (survey.explained.get(n) for n in (name, force))
    beside = "" if best is None else f", and {max(best, 0.0):.0%} of {force!r}"
    explained = (
        "" if share is None else f": the motion explains {max(share, 0.0):.0%} of it{beside}"
    )
    second = likeness(name, "actuator_force") >= SURE_NAME
    return (
        f"a second force beside {force!r}{explained}"
        if second
        else f"its name is not that of a force{explained}"
    )

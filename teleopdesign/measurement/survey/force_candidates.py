"""Which columns of a log may be a force beside its position, before physics compares them."""

from __future__ import annotations

from collections.abc import Callable

from ...base.units import is_unit
from ..column_names import likeness, words_of
from ..law_of_readings import is_copy
from .axes import same_but_axis
from .content import (
    SURE_NAME,
    Array,
    Survey,
    SurveyedColumn,
    is_unit_of,
    moves,
    rises,
    sample_time_of,
)
from .copies import repeats_mostly
from .derivative import (
    has_signs_of_steps,
    is_acceleration,
    is_velocity,
    may_be_ramp,
)
from .other_motions import agreements, other_motions, planned_paths
from .set_point import has_numbers_of, is_sent_to_places, may_be_set_point


def possible_forces(
    survey: Survey, position: str, velocity: str | None, used: set[str | None], x: Array
) -> dict[str, SurveyedColumn]:
    """The columns that may be a force beside a position, whose values are x (n,)."""
    moving = {n: c for n, c in survey.columns.items() if n not in used and moves(c)}
    set_points = [
        c.values for c in moving.values() if may_be_set_point(c) and has_numbers_of(c.values, x)
    ]
    h = sample_time_of(survey)
    nameless = {n: c.values for n, c in survey.columns.items() if moves(c) and _is_nameless(c)}
    rates = agreements(nameless, h)
    survey.motions = other_motions(rates, nameless, x, h)
    paths = planned_paths(rates) | {*survey.motions, *survey.motions.values()}
    places = [survey.columns[name].values for name in places_of_steps(survey)]
    rate = None if velocity is None else survey.columns[velocity].values
    rules: tuple[Callable[[SurveyedColumn], bool], ...] = (
        lambda c: not c.unit or is_unit_of(c.unit, "force") or not is_unit(c.unit),
        # "joint1" beside the position "joint2" is the position of another axis
        lambda c: likeness(c.name, "actuator_force") > 0 or not same_but_axis(c.name, position),
        # the error of a controller is the position once more
        lambda c: _names_force(c) or not is_copy(c.values, x),
        # neither a set point nor a commanded speed is a force
        lambda c: not is_set_point(c, x),
        lambda c: (
            not may_be_set_point(c)
            or not any(repeats_mostly(c.values, other) for other in set_points)
        ),
        lambda c: not is_speed(c, survey, velocity),
        lambda c: not is_acceleration(c, rate, h),
        lambda c: c.name not in paths,
        # nor is the position of another axis, or its error
        lambda c: not _is_nameless(c) or not any(is_copy(c.values, other) for other in places),
    )
    return {
        name: column
        for name, column in moving.items()
        if all(rule(column) or is_unit_of(column.unit, "force") for rule in rules)
        and (not rises(column.readings) or may_be_ramp(column))
    }


def is_set_point(column: SurveyedColumn, x: Array) -> bool:
    """Whether a column is a set point of a position x (n,), in its unit or in another one."""
    same = may_be_set_point(column) and has_numbers_of(column.values, x)
    return same or is_sent_to_places(x, column)


def _names_force(column: SurveyedColumn) -> bool:
    """Whether a name contains a word of a force, of the actuator or of the hand."""
    return max(likeness(column.name, f"{whose}_force") for whose in ("actuator", "interaction")) > 0


def _is_nameless(column: SurveyedColumn) -> bool:
    """Whether neither unit nor name of a column says anything: "column 3", "CH2"."""
    kinds = ("position", "velocity", "actuator_force", "interaction_force")
    return column.unit is None and not any(likeness(column.name, kind) > 0 for kind in kinds)


def is_speed(column: SurveyedColumn, survey: Survey, velocity: str | None = None) -> bool:
    """Whether a column is a velocity by a word of its name, or by its numbers.

    A symbol is no such word: "v" may be a voltage as well. By its numbers it has the sign of each
    step of the position, or it is the velocity once more: in another unit, or a control error.

    velocity: the column of the velocity, if there is one
    """
    if place_of_steps(column, survey) is not None:
        return True
    if velocity not in (None, column.name) and not _names_force(column):
        if is_copy(column.values, survey.columns[velocity].values):
            return True
    word = any(len(w) > 1 and likeness(w, "velocity") >= SURE_NAME for w in words_of(column.name))
    return word and is_velocity(column)


def place_of_steps(column: SurveyedColumn, survey: Survey) -> str | None:
    """The column of whose steps another one has the signs, as its speed; None: there is none.

    It is the position, or among columns without names also that of another axis.
    """
    position = survey.channels["position"]["column"]
    if column.name == position or _names_force(column):
        return None
    others = {n: c for n, c in survey.columns.items() if n != column.name and moves(c)}
    if not _is_nameless(column):
        others = {position: survey.columns[position]}
    return next((n for n, c in others.items() if _is_place(c, column, position)), None)


def _is_place(place: SurveyedColumn, column: SurveyedColumn, position: str) -> bool:
    """Whether a column is the position or has no name, and its steps have the signs of another."""
    return (place.name == position or _is_nameless(place)) and has_signs_of_steps(place, column)


def places_of_steps(survey: Survey) -> dict[str, str]:
    """The columns without a name whose speed is in the log, but for the position: name -> speed."""
    position = survey.channels["position"]["column"]
    nameless = [c for c in survey.columns.values() if _is_nameless(c) and moves(c)]
    speeds = {c.name: place_of_steps(c, survey) for c in nameless}
    return {place: n for n, place in speeds.items() if place is not None and place != position}

"""Which columns of a log may be a force beside its position, before physics compares them."""

from __future__ import annotations

from collections.abc import Callable

from ...quantity import is_unit
from ..column_names import likeness, words_of
from .axes import same_but_axis
from .content import SURE_NAME, Array, Survey, SurveyedColumn, is_unit_of, moves, rises
from .copies import is_copy, repeats_mostly
from .derivative import is_velocity
from .set_point import has_numbers_of, may_be_set_point


def possible_forces(
    survey: Survey, position: str, used: set[str | None], x: Array
) -> dict[str, SurveyedColumn]:
    """The columns that may be a force beside a position, whose values are x (n,)."""
    moving = {n: c for n, c in survey.columns.items() if n not in used and moves(c)}
    set_points = [
        c.values for c in moving.values() if may_be_set_point(c) and has_numbers_of(c.values, x)
    ]
    rules: tuple[Callable[[SurveyedColumn], bool], ...] = (
        lambda c: not rises(c.readings),
        lambda c: not c.unit or is_unit_of(c.unit, "force") or not is_unit(c.unit),
        # "joint1" beside the position "joint2" is the position of another axis
        lambda c: likeness(c.name, "actuator_force") > 0 or not same_but_axis(c.name, position),
        # the error of a controller is the position once more
        lambda c: _names_force(c) or not is_copy(c.values, x),
        # neither a set point nor a commanded speed is a force
        lambda c: not (may_be_set_point(c) and has_numbers_of(c.values, x)),
        lambda c: (
            not may_be_set_point(c)
            or not any(repeats_mostly(c.values, other) for other in set_points)
        ),
        lambda c: not is_speed(c),
    )
    return {
        name: column
        for name, column in moving.items()
        if all(rule(column) or is_unit_of(column.unit, "force") for rule in rules)
        and not rises(column.readings)
    }


def _names_force(column: SurveyedColumn) -> bool:
    """Whether a name contains a word of a force, of the actuator or of the hand."""
    return max(likeness(column.name, f"{whose}_force") for whose in ("actuator", "interaction")) > 0


def is_speed(column: SurveyedColumn) -> bool:
    """Whether a word of a name says velocity; a symbol does not: "v" may be a voltage as well."""
    word = any(len(w) > 1 and likeness(w, "velocity") >= SURE_NAME for w in words_of(column.name))
    return word and is_velocity(column)

"""Which columns of a log are position and velocity; axis, unit, wrap and resolution."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...base.units import is_unit, measures, si_factor
from ..column_names import (
    is_another_quantity,
    is_wanted,
    likeness,
    why_no_unit,
)
from ..encoder import ENOUGH, grid_of, reading_step
from .axes import axis_that_moves
from .axis_kind import MOST_ANGLE, drives_in_turns, guess_counts_per_turn, is_counter
from .content import (
    OF_SENSORS,
    SURE_NAME,
    Array,
    Choices,
    Survey,
    SurveyedColumn,
    as_likely,
    columns_in_use,
    explain_ambiguity,
    is_unit_of,
    kinds_of,
    moves,
    sample_time_of,
)
from .derivative import (
    DERIVATIVE,
    NEAR_USUAL,
    SAME,
    derivative_factor,
    follows_direction,
    is_no_velocity,
    is_velocity,
    may_be_position,
    rate_agreement,
    turn_of,
    unwrap_column,
    wrap_of,
)
from .force_entry import describe_code
from .refusals import error_without_position, has_only_speeds
from .set_point import followed_columns, may_be_set_point, most_explained
from .words import says

#: correlation that a matching name counts for: the error of a controller also follows the velocity
BY_NAME = 0.1
#: part of a step by which readings at the end of a range may lie beside a grid of rounded steps
OFF_GRID = 0.1


def find_position(
    survey: Survey, time_name: str | None, choices: Choices, file: str
) -> tuple[str, str | None]:
    """The column of the position, and that of its velocity or None."""
    h = sample_time_of(survey)
    free = {n: c for n, c in survey.columns.items() if moves(c) and n not in columns_in_use(survey)}
    chosen = choices.position
    if choices.states_all:  # only its velocity is looked for, among the columns that are called so
        free = {n: c for n, c in free.items() if n == chosen or is_velocity(c)}
    moving = {n: c for n, c in free.items() if n == chosen or may_be_position(n, survey.columns, h)}
    flat = {n: unwrap_column(c.values, wrap_of(c.values)) for n, c in moving.items()}
    followed = followed_columns(_without_names(moving, flat))
    derivative: dict[str, tuple[str, float]] = {}
    scores: dict[str, float] = {}
    for name, column in moving.items():
        is_set_point = is_wanted(name) or name in followed.values()
        score = likeness(name, "position") - 0.8 * is_set_point + 0.4 * (name in followed)
        score -= 1.2 * says(name, "difference")  # below a column whose name says nothing
        kinds = kinds_of(column)
        score += 0.5 * ("position" in kinds) - 0.8 * bool(kinds and "position" not in kinds)
        score -= 0.4 * max(likeness(name, "velocity"), likeness(name, "actuator_force"))
        for other, column_2 in moving.items():
            if other == name or is_no_velocity(column_2):
                continue
            agree = rate_agreement(flat[name], column_2.values, h)
            if not is_velocity(column_2) and follows_direction(flat[name], column_2.values, h):
                continue
            # a desired velocity agrees with the position as well, and better where it is smooth
            sure = agree + BY_NAME * likeness(other, "velocity") - 2.0 * BY_NAME * is_wanted(other)
            if agree > DERIVATIVE and sure > derivative.get(name, ("", 0.0))[1]:
                derivative[name] = (other, sure)
        scores[name] = score + 0.4 * (name in derivative)
    # a column whose name or unit is of something else is never a position
    known = choices.units  # except with a chosen unit: a wrong choice is refused with its name
    scores = {n: s for n, s in scores.items() if n in known or not _is_another(moving[n])}
    if choices.position is not None:
        best = choices.position
    elif scores:
        best = max(scores, key=lambda n: scores[n])
        if likeness(best, "position") == 0:
            best = most_explained([best, *as_likely(scores, best)], flat, h)
        travels = {n: float(np.ptp(x)) for n, x in flat.items()}
        best = axis_that_moves(best, as_likely(scores, best), travels, survey.columns)
        shown = best in derivative or best in followed
        if not shown and has_only_speeds(moving[best], moving):
            raise error_without_position(survey, moving, file, best)
        _note_choice(survey, best, scores, derivative, followed)
    else:
        raise error_without_position(survey, moving, file)
    velocity = derivative.get(best, (None, 0.0))[0]
    if velocity is not None:
        survey.notes.append(f"{velocity!r} is the derivative of {best!r}")
    return best, velocity


def _note_choice(
    survey: Survey,
    best: str,
    scores: Mapping[str, float],
    derivative: Mapping[str, object],
    followed: Mapping[str, str],
) -> None:
    """Mark the chosen column as a guess, with the reason, where its name alone does not decide."""
    key, others = "channels.position.column", as_likely(scores, best)
    if likeness(best, "position") >= SURE_NAME:
        if others:
            survey.guesses[key] = explain_ambiguity(best, others, "the position")
        return
    unit = survey.columns[best].unit
    if best in followed:
        why = f"it follows {followed[best]!r}, as a position follows its set point"
    elif best in derivative:
        why = "another column is its derivative"
    elif likeness(best, "position") > 0 or is_unit_of(unit, "position"):
        why = "name or unit suggest a position"
    elif others:
        why = "its motion explains more of another column than those of other columns do"
    else:
        why = "it is the first column that moves"
    survey.guesses[key] = f"{best!r} is read as the position: {why}"


def _without_names(
    moving: Mapping[str, SurveyedColumn], flat: Mapping[str, Array]
) -> dict[str, Array]:
    """The columns that may be a position or its set point, and whose names do not say which."""
    return {
        name: flat[name]
        for name, column in moving.items()
        if likeness(name, "position") < SURE_NAME
        and not _is_another(column)
        and may_be_set_point(column)
    }


def _is_another(column: SurveyedColumn) -> bool:
    """Whether a column is no position, by its unit or, without a unit, by its name.

    A potentiometer may be logged in mV, a valve in per cent of its stroke, and the last letters of
    a name may be no unit: "q_ms".
    """
    if is_unit_of(column.unit, "position") or is_unit_of(column.unit, "time"):
        return False
    named = likeness(column.name, "position")
    if column.unit is not None and is_unit(column.unit):
        return not (named >= SURE_NAME and column.unit in ("mV", "%"))
    if named == 0:
        others = ("velocity", "actuator_force", "interaction_force")
        no_position = max(likeness(column.name, other) for other in others) >= SURE_NAME
        return no_position or is_another_quantity(column.name)
    return False


def describe_position(
    survey: Survey, position: str, velocity: str | None, choices: Choices
) -> None:
    """Set the channels of position and velocity: unit, wrap, resolution and gear ratio."""
    column, axis = survey.columns[position], survey.axis
    entry: dict[str, Any] = {"column": position, **describe_code(survey, position, "position")}
    unit = choices.units.get(position) or column.unit
    if unit is None and choices.counts_per_turn is not None:
        unit = "counts"
    if unit is None and axis == "revolute" and is_counter(column):
        unit = "counts"
        survey.guesses["channels.position.unit"] = (
            f"counts: {position!r} holds whole numbers, as the counter of an encoder does"
        )
    if unit is None or unit != "counts" and not measures(unit, "position", axis):
        unit, why = _position_unit(survey, column, velocity, axis)
        survey.guesses["channels.position.unit"] = why
    entry["unit"] = unit
    jump = wrap_of(column.values)
    factor = 1.0
    if unit == "counts":
        per_turn = choices.counts_per_turn
        if per_turn is None:
            per_turn = guess_counts_per_turn(survey, column, velocity, jump)
        entry["counts_per_turn"] = per_turn
    else:
        factor = si_factor(unit, quantity="position", axis=axis)
        step = _step_of_readings(column.readings)
        if step > 0:
            entry["resolution"] = _with_few_digits(step, float(np.ptp(column.values)))
            survey.notes.append(f"{position!r} moves in steps of {step:.4g} {unit}")
    if jump is not None:
        turn = 2 * math.pi / factor
        whole = axis == "revolute" and unit != "counts" and abs(jump / turn - 1.0) < NEAR_USUAL
        entry["unwrap"] = True if whole else jump
        survey.notes.append(f"{position!r} wraps at {jump:g}")
    if choices.gear_ratio is not None:
        entry["gear_ratio"] = choices.gear_ratio
    survey.channels["position"] = entry
    if velocity is not None:
        velocity_unit = choices.units.get(velocity) or survey.columns[velocity].unit
        if velocity_unit is not None and measures(velocity_unit, "velocity", axis):
            more: dict[str, Any] = (
                {} if choices.gear_ratio is None else {"gear_ratio": choices.gear_ratio}
            )
            more |= describe_code(survey, velocity, "velocity")
            survey.channels["velocity"] = {"column": velocity, "unit": velocity_unit, **more}
            _hold_time_against(survey, column, velocity)


def _hold_time_against(survey: Survey, column: SurveyedColumn, velocity: str) -> None:
    """Check a guessed unit of time: a position and its velocity show the true time step."""
    why = survey.guesses.get("channels.time.unit")
    unit, velocity_unit = (survey.channels[key]["unit"] for key in ("position", "velocity"))
    if why is None or unit == "counts" or "channels.position.unit" in survey.guesses:
        return
    h = sample_time_of(survey)
    whole = unwrap_column(column.values, wrap_of(column.values))
    factor, agree = derivative_factor(whole, survey.columns[velocity].values, h)
    slower = factor * si_factor(velocity_unit, quantity="velocity", axis=survey.axis)
    slower /= si_factor(unit, quantity="position", axis=survey.axis)
    if agree < DERIVATIVE or slower <= 0 or abs(slower - 1.0) < SAME:
        return
    clock = survey.channels["time"]
    tick = 1e6 * si_factor(clock["unit"], quantity="time") / slower
    stated = f"{clock['column']}={float(f'{tick:.3g}'):g} us"
    survey.guesses["channels.time.unit"] = (
        f"{why}; but {velocity!r} in {velocity_unit} requires steps of {h / slower:.3g} s: "
        f"--unit {stated!r}"
    )


def _step_of_readings(values: Array) -> float:
    """Step of the encoder, estimated from the readings; 0 if they show none."""
    raw = values[:ENOUGH]
    changes = int(np.count_nonzero(np.diff(raw)))
    return grid_of(raw, reading_step(raw)) if changes >= 9 else 0.0


def _with_few_digits(step: float, reach: float) -> float:
    """A step with as few digits as keep it on its grid over a whole range."""
    rounded = (float(f"{step:.{digits}g}") for digits in range(5, 17))
    return next((r for r in rounded if abs(r / step - 1.0) * reach < OFF_GRID * step), step)


def unit_of_reach(reach: float, axis: str) -> str:
    """The usual unit of a position whose readings have this range."""
    if axis == "revolute":
        return "deg" if reach > MOST_ANGLE else "rad"
    return "mm" if reach > 3 else "m"


def _position_unit(
    survey: Survey, column: SurveyedColumn, velocity: str | None, axis: str
) -> tuple[str, str]:
    """A unit for a position without one, from its velocity or from its range; and the reason."""
    whole = unwrap_column(column.values, wrap_of(column.values))
    reach = float(np.ptp(whole))
    if velocity is not None and (velocity_unit := survey.columns[velocity].unit):
        factor, _ = derivative_factor(
            whole, survey.columns[velocity].values, sample_time_of(survey)
        )
        scale = (
            factor * si_factor(velocity_unit, quantity="velocity", axis=axis)
            if measures(velocity_unit, "velocity", axis)
            else 0.0
        )
        for unit in ("deg", "rad", "turns") if axis == "revolute" else ("mm", "m", "um"):
            if abs(scale / si_factor(unit, quantity="position", axis=axis) - 1.0) < SAME:
                why = f"with it, the derivative agrees with {velocity!r} in {velocity_unit}"
                return unit, f"{unit}: {why}"
    if axis == "revolute" and (drives := drives_in_turns(column.name)):
        return "turns", f"turns: {' and '.join(drives)} drives report turns"
    if axis == "revolute" and (turn := turn_of(column.values)) is not None:
        return turn, f"{turn}: the readings wrap at a turn in {turn}"
    unit = unit_of_reach(reach, axis)
    why = why_no_unit(column.name, column.unit, "position", axis)
    more = f", `scale` = {unit} per {column.unit} is missing" if column.unit in OF_SENSORS else ""
    return unit, f"{unit}: {why}, and the readings have a range of {reach:.3g}{more}"

"""Which columns of a log are position and velocity; axis, unit, wrap and resolution."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from ...base.units import measures, si_factor
from ..column_names import (
    is_wanted,
    likeness,
    why_no_unit,
)
from ..encoder import ENOUGH, Array, grid_of, reading_step
from ..limits import SMALL
from .axes import of_another_axis
from .axis_kind import (
    MOST_ANGLE,
    drives_in_turns,
    guess_counts_per_turn,
    is_counter,
    is_rate,
    size_by_velocity,
)
from .content import (
    OF_SENSORS,
    SURE_NAME,
    Choices,
    Survey,
    SurveyedColumn,
    columns_in_use,
    explain_ambiguity,
    is_unit_of,
    moves,
    sample_time_of,
)
from .derivative import (
    DERIVATIVE,
    NEAR_USUAL,
    follows_direction,
    is_no_velocity,
    is_velocity,
    leaps,
    may_be_position,
    rate_agreement,
    turn_of,
    unwrap_column,
    wrap_of,
)
from .force_entry import describe_code
from .forces import score_beside
from .refusals import error_without_position
from .roles import as_likely, first_of, is_nameless, is_no_position, score_of
from .set_point import lags, may_be_set_point


def find_position(survey: Survey, choices: Choices, file: str) -> tuple[str, str | None]:
    """The column of the position, and that of its velocity or None.

    raises ExperimentError: no column may be the position
    """
    chosen, h = choices.position, sample_time_of(survey)
    columns, used = survey.columns, columns_in_use(survey)
    moving = {n: c for n, c in columns.items() if moves(c) and n not in used}
    if choices.states_all:  # only its velocity is looked for, among the columns that are called so
        moving = {n: c for n, c in moving.items() if n == chosen or is_velocity(c)}
    moving = {n: c for n, c in moving.items() if n == chosen or may_be_position(n, columns, h)}
    flat = {n: unwrap_column(c.values, wrap_of(c.values)) for n, c in moving.items()}
    # a wrong unit that is stated is refused later, with its name
    may_be = [n for n, c in moving.items() if n in choices.units or not is_no_position(c)]
    may_be = may_be if chosen is None else [chosen]
    velocities = {n: _velocity_of(n, moving, flat, h) for n in may_be}
    if chosen is None:
        followed = {} if len(may_be) < 2 else _followed_columns(may_be, moving, flat)
        scores = {
            n: score_of(
                "position",
                moving[n],
                its_velocity_is_logged=velocities[n] is not None,
                it_follows_a_column=n in followed,
                a_column_follows_it=n in followed.values(),
                it_leaps=likeness(n, "position") < SURE_NAME and leaps(flat[n]),
            )
            for n in may_be
        }
        best = max(scores, key=lambda n: scores[n], default=None)
        if best is None:
            raise error_without_position(survey, moving, file)
        if alike := as_likely(scores, best):
            motions = ((n, velocities[n], flat[n]) for n in (best, *alike))
            best = first_of({n: score_beside(survey, n, v, x) for n, v, x in motions})
        # a velocity of no column's motion is that of a body whose position is not in the log
        speeds = (n for n, c in moving.items() if n != best and is_velocity(c) and not is_wanted(n))
        shown = velocities[best] is not None or best in followed
        if is_nameless(moving[best]) and not shown and any(speeds):
            raise error_without_position(survey, moving, file, best)
        _note_choice(survey, best, scores, velocities[best], followed)
    else:
        best = chosen
    velocity = velocities[best]
    if velocity is not None:
        survey.notes.append(f"{velocity!r} is the derivative of {best!r}")
    return best, velocity


def _velocity_of(
    name: str, moving: Mapping[str, SurveyedColumn], flat: Mapping[str, Array], h: float
) -> str | None:
    """The most likely column that is the derivative of another one; None: there is none.

    Those of another axis by their names are looked at where no other is the derivative.
    """
    others = {n: c for n, c in moving.items() if n != name and not is_no_velocity(c)}
    apart = {n for n in others if of_another_axis(n, name, moving)}
    for group in (others.keys() - apart, apart):
        scores: dict[str, tuple[float, float]] = {}
        for other in (n for n in others if n in group):
            column = others[other]
            agree = rate_agreement(flat[name], column.values, h)
            if agree < DERIVATIVE:
                continue
            if is_velocity(column) or not follows_direction(flat[name], column.values, h):
                scores[other] = score_of("velocity", column, left=1.0 - agree), agree
        if scores:
            return max(scores, key=scores.__getitem__)
    return None


def _followed_columns(
    may_be: Sequence[str], moving: Mapping[str, SurveyedColumn], flat: Mapping[str, Array]
) -> dict[str, str]:
    """Column -> the column that it follows as a position its set point, where no name tells."""
    free = [
        n for n in may_be if likeness(n, "position") < SURE_NAME and may_be_set_point(moving[n])
    ]
    ahead = [n for n in may_be if n in free or is_wanted(n)]
    pairs = ((n, m) for n, m in product(free, ahead) if n != m)
    return {n: m for n, m in pairs if lags(flat[n], flat[m])}


def _note_choice(
    survey: Survey,
    best: str,
    scores: Mapping[str, float],
    velocity: str | None,
    followed: Mapping[str, str],
) -> None:
    """Mark the chosen column as a guess, with the reason, where its name alone does not decide."""
    key, others = "channels.position.column", as_likely(scores, best)
    if likeness(best, "position") >= SURE_NAME:
        if others:
            survey.guesses[key] = explain_ambiguity(best, others, "the position")
        return
    if best in followed:
        why = f"it follows {followed[best]!r}, as a position follows its set point"
    elif velocity is not None:
        why = "another column is its derivative"
    elif likeness(best, "position") > 0 or is_unit_of(survey.columns[best].unit, "position"):
        why = "name or unit suggest a position"
    elif others:
        why = "its motion explains more of another column than those of other columns do"
    else:
        why = "it is the first column that moves"
    survey.guesses[key] = f"{best!r} is read as the position: {why}"


def describe_position(
    survey: Survey, position: str, velocity: str | None, choices: Choices
) -> None:
    """Set the channels of position and velocity: unit, wrap, resolution and gear ratio."""
    column, axis = survey.columns[position], survey.axis
    gear = {} if choices.gear_ratio is None else {"gear_ratio": choices.gear_ratio}
    entry: dict[str, Any] = {"column": position, **describe_code(survey, position, "position")}
    unit = column.unit
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
    survey.channels["position"] = entry | gear
    if velocity is not None and is_rate(survey, velocity):
        rate = {"column": velocity, "unit": survey.columns[velocity].unit, **gear}
        survey.channels["velocity"] = rate | describe_code(survey, velocity, "velocity")


def _step_of_readings(values: Array) -> float:
    """Step of the encoder, estimated from the readings; 0 if they show none."""
    raw = values[:ENOUGH]
    return grid_of(raw, reading_step(raw))


def _with_few_digits(step: float, reach: float) -> float:
    """A step with as few digits as keep it on its grid over a whole range."""
    rounded = (float(f"{step:.{digits}g}") for digits in range(5, 17))
    return next((r for r in rounded if abs(r / step - 1.0) * reach < SMALL * step), step)


def unit_of_reach(reach: float, axis: str) -> str:
    """The usual unit of a position whose readings have this range."""
    if axis == "revolute":
        return "deg" if reach > MOST_ANGLE else "rad"
    return "mm" if reach > 3 else "m"


def _position_unit(
    survey: Survey, column: SurveyedColumn, velocity: str | None, axis: str
) -> tuple[str, str]:
    """A unit for a position without one, from its velocity or from its range; and the reason."""
    reach = float(np.ptp(unwrap_column(column.values, wrap_of(column.values))))
    size = 0.0 if velocity is None else size_by_velocity(survey, column, velocity)
    for unit in ("deg", "rad", "turns") if axis == "revolute" else ("mm", "m", "um"):
        if abs(size / si_factor(unit, quantity="position", axis=axis) - 1.0) < SMALL:
            in_unit = f"{velocity!r} in {survey.columns[velocity or ''].unit}"
            return unit, f"{unit}: with it, the derivative agrees with {in_unit}"
    if axis == "revolute" and (drives := drives_in_turns(column.name)):
        return "turns", f"turns: {' and '.join(drives)} drives report turns"
    if axis == "revolute" and (turn := turn_of(column.values)) is not None:
        return turn, f"{turn}: the readings wrap at a turn in {turn}"
    unit = unit_of_reach(reach, axis)
    why = why_no_unit(column.name, column.unit, "position", axis)
    more = f", `scale` = {unit} per {column.unit} is missing" if column.unit in OF_SENSORS else ""
    return unit, f"{unit}: {why}, and the readings have a range of {reach:.3g}{more}"

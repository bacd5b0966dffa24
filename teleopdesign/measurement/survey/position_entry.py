"""The position of a log as an entry of experiment.toml: axis, unit, counts, wrap and resolution."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ...base.units import AXES, is_unit, measures, si_factor
from ..column_names import why_no_unit, words_of
from ..encoder import ENOUGH, Array, grid_of, reading_step
from ..limits import SMALL
from .content import OF_SENSORS, Choices, Survey, SurveyedColumn, counts_per_turn_in, sample_time_of
from .derivative import (
    DERIVATIVE,
    NEAR_USUAL,
    USUAL_COUNTS,
    derivative_factor,
    turn_of,
    unwrap_column,
    wrap_of,
)
from .force_entry import describe_code
from .roles import SAYS, says

#: counts per turn if nothing in the log determines them
USUAL = 4096.0
#: range above which whole numbers are counts: of a counter by its name, and of any other name;
#: angles may be whole degrees of many turns
MOST_ANGLE, MOST_DEGREES = 50, 1000


def drives_in_turns(name: str) -> list[str]:
    """The drives that report turns under this name; ODrives call it "pos_estimate"."""
    words = set(words_of(name))
    return sorted({*SAYS["drive in turns"]} & words) or ["ODrive"] * ({"pos", "estimate"} <= words)


def axis_of(survey: Survey, position: str, choices: Choices) -> str:
    """The axis: the user's choice, or from the unit of the position, or a guess."""
    if choices.axis is not None:
        return choices.axis
    unit = survey.columns[position].unit
    if unit is not None and unit != "counts":
        for axis in ("prismatic", "revolute"):
            if measures(unit, "position", axis):
                return axis
    if choices.torque_constant is not None and turn_of(survey.columns[position].values) is None:
        force = choices.torque_constant[1].rpartition("/")[0]
        return "revolute" if measures(force, "force", "revolute") else "prismatic"
    axis, why = next(_signs_of_axis(survey, position))
    survey.guesses["model.device.axis"] = f"the axis is {axis}: {why}"
    return axis


def _signs_of_axis(survey: Survey, position: str) -> Iterator[tuple[str, str]]:
    """Axes and what tells them, the surest first."""
    column = survey.columns[position]
    if (turn := turn_of(column.values)) is not None:
        yield "revolute", f"{position!r} wraps at a turn in {turn}"
    units = [c.unit for c in survey.columns.values() if c.unit and is_unit(c.unit)]
    rates = {a: u for a in AXES for u in reversed(units) if measures(u, "velocity", a)}
    if len(rates) == 1:
        yield from ((axis, f"a velocity is in {unit}") for axis, unit in rates.items())
    forces, lengths = ([u for u in units if measures(u, q)] for q in ("force", "position"))
    turned = [u for u in units if measures(u, "force", "revolute")]
    if forces and not turned:
        yield "prismatic", f"forces are in {forces[0]}"
    if lengths:
        yield "prismatic", f"a column is in {lengths[0]}"
    if turned and not forces:
        yield "revolute", f"forces are in {turned[0]}"
    if says(position, "sliding") and not says(position, "limb", "angle"):
        yield "prismatic", f"the name {position!r} is that of a part that slides"
    if says(position, "turning", "limb", "angle") or drives_in_turns(position):
        yield "revolute", f"the name {position!r} is that of an angle"
    for name in (name for name in survey.columns if says(name, "turning torque")):
        yield "revolute", f"the name {name!r} is that of a torque"
    if column.unit is None and is_counter(column):
        yield "revolute", f"{position!r} holds whole numbers, as the counter of an encoder does"
    turns = column.unit == "counts" or "A" in units
    why = "no unit and no name of a column determines the axis"
    yield "revolute" if turns else "prismatic", why


def is_counter(column: SurveyedColumn) -> bool:
    """Whether a column without a unit is the counter of an encoder, by its whole numbers."""
    values = column.readings[np.isfinite(column.readings)]
    if not np.all(values == np.round(values)):
        return False
    most = math.inf if says(column.name, "angle") else MOST_DEGREES
    most = MOST_ANGLE if says(column.name, "counter") else most
    return float(np.ptp(values)) > most


def guess_counts_per_turn(
    survey: Survey, column: SurveyedColumn, velocity: str | None, jump: float | None
) -> float:
    """Counts per turn by the header of the log, the velocity, or the wrap; the guess is noted.

    jump: counts by which the position wraps; None: the position does not wrap
    """
    per_turn = jump or USUAL
    why = "the log does not state them, see the data sheet of the encoder"
    if (in_header := counts_per_turn_in(survey.remarks)) is not None:
        per_turn, line = in_header
        why = f"a line of the log states {line!r}"
    elif velocity is not None and (size := size_by_velocity(survey, column, velocity)) > 0.0:
        counted = 2 * math.pi / size
        usual = min(USUAL_COUNTS, key=lambda one: abs(math.log(counted / one)))
        if abs(counted / usual - 1.0) < NEAR_USUAL:
            per_turn, unit = usual, survey.columns[velocity].unit
            why = f"with them, the derivative agrees with {velocity!r} in {unit}"
    survey.guesses["channels.position.counts_per_turn"] = f"{per_turn:g} counts per turn: {why}"
    return per_turn


def is_rate(survey: Survey, velocity: str) -> bool:
    """Whether the unit of a column is that of a velocity on this axis."""
    unit = survey.columns[velocity].unit
    return unit is not None and measures(unit, "velocity", survey.axis)


def size_by_velocity(survey: Survey, column: SurveyedColumn, velocity: str) -> float:
    """One unit of a position's column in SI, by the derivative that its velocity is; 0: unknown."""
    speed = survey.columns[velocity]
    if speed.unit is None or not is_rate(survey, velocity):
        return 0.0
    whole = unwrap_column(column.values)
    factor, agree = derivative_factor(whole, speed.values, sample_time_of(survey))
    size = factor * si_factor(speed.unit, quantity="velocity", axis=survey.axis)
    return size if agree > DERIVATIVE else 0.0


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
    reach = float(np.ptp(unwrap_column(column.values)))
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

"""The clock of a log: which column is its time, the rate without one, and an even grid for all."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np

from ...base.units import is_several_times, measures, si_factor
from ..column_names import bare_name, is_wanted, likeness, unit_in_name, unit_of_text, words_of
from ..doors._log import Log
from ..encoder import Array, sign_code_of
from ..limits import FEWEST, HALF, SEVERAL, SMALL
from ..record_clock import clock_of
from ..repeated_rows import rows_between_readings
from ..spikes import lost_zeros
from ..stamps import (
    are_out_of_order,
    seconds_since_first,
    step_deviations,
    unit_of_steps,
    unit_of_time,
    unwrap_stamps,
)
from .content import ASSUMED, SURE_NAME, Choices, SurveyedColumn, rises, sample_rate_in
from .derivative import DERIVATIVE, derivative_factor, has_both_signs, unwrap_column
from .roles import is_unit_of, says, says_only, score_of, unit_in_log

#: quantities whose units are not those of a time
QUANTITIES = ("position", "velocity", "force")
#: part by which a rate with fewer digits may be off: a derivative along rows tells it no better
ROUNDED = 0.005
#: rows that are looked at
MOST = 60_000
#: units in which load cells are read, and those of the weight that acts
WEIGHTS = {"kg": "kgf"}


def time_column(
    raw: Mapping[str, Array],
    log: Log,
    choices: Choices,
    guesses: dict[str, str],
) -> tuple[str | None, str]:
    """The name of the time column, None if there is none, and its unit."""
    if choices.sample_rate is not None:
        return None, "s"
    if choices.time is not None:
        name = choices.time
    elif log.clocks:
        name = busiest_clock(log, raw, choices)
    else:
        scores = score_times(raw, log, choices)
        if not scores:
            guesses["sample_rate"] = f"no column rises as a time does: {ASSUMED:g} Hz is assumed"
            return None, "s"
        name = max(scores, key=lambda n: scores[n])
        counted = name not in choices.units and counts_rows(raw[name])
        if not is_called_time(name) and counted and sample_rate_in(log.remarks):
            return None, "s"
        if why := why_time(name, list(scores), raw, choices):
            guesses["channels.time.column"] = f"{name!r} is read as the time: {why}"
    unit = unit_of_time(name, choices.units.get(name) or log.units.get(name))
    if name in choices.units and is_several_times(choices.units[name]):
        return name, choices.units[name]
    if unit is None:
        unit, why = unit_of_steps(raw[name])
        if why:
            counted = "channels.time.column" in guesses and counts_rows(raw[name])
            more = "; if it counts the rows: --sample-rate HZ" if counted else ""
            guesses["channels.time.unit"] = why + more
    return name, unit


def duration_of(
    raw: Mapping[str, Array], time_name: str | None, unit: str, choices: Choices
) -> float:
    """Time from the first to the last row of the whole log, s."""
    return float(np.nanmax(seconds_since_first(_stamps_of(raw, time_name, unit, choices))))


def _stamps_of(
    raw: Mapping[str, Array], time_name: str | None, unit: str, choices: Choices
) -> Array:
    """The time of each row (n,), s: as written, or counted."""
    if time_name is None:
        return np.arange(max(map(len, raw.values()))) / (choices.sample_rate or ASSUMED)
    return raw[time_name] * si_factor(unit, quantity="time")


def interpolate_columns(
    raw: Mapping[str, Array],
    log: Log,
    time_name: str | None,
    unit: str,
    choices: Choices,
    file: str,
) -> tuple[Array, dict[str, SurveyedColumn]]:
    """The time of an even grid (n,), and all columns on it by linear interpolation.

    This is accurate enough to recognise the quantities.
    """
    stamps = _stamps_of(raw, time_name, unit, choices)
    beside_time = {n: x for n, x in raw.items() if len(x) == len(stamps)}
    rows = np.flatnonzero(np.isfinite(stamps))[:MOST]
    origin = stamps[rows[0]]
    signals = [x[rows] for n, x in beside_time.items() if n != time_name and not rises(x[rows])]
    rows = rows[~rows_between_readings(signals, signals, stamps[rows])]
    clock = clock_of(stamps[rows] - origin, (slice(0, len(rows)),), file)
    used = rows[clock.rows]
    columns: dict[str, SurveyedColumn] = {}
    for name, values in raw.items():
        if name == time_name:
            continue
        clock_name = log.clocks.get(name)
        at, x = clock.time[clock.places], values
        if clock_name is not None and clock_name != time_name and name not in log.clocks.values():
            at = raw[clock_name] - origin
        elif name in beside_time:
            x = values[used]
        else:
            continue
        fine = np.isfinite(x) & np.isfinite(at)
        if fine.sum() < 2:
            continue
        column_unit = unit_in_log(name, log, choices)
        column_unit = WEIGHTS.get(column_unit or "", column_unit)
        # the counter of a position wraps, which is the same as a sign
        is_position = likeness(name, "position") >= SURE_NAME and not is_wanted(name)
        fine &= ~lost_zeros(x) if is_position else True
        code = None if is_position else sign_code_of(x[fine])
        readings = x[fine] if code is None else code.decode(x[fine])
        grid = np.interp(clock.time, at[fine], readings)
        columns[name] = SurveyedColumn(name, grid, readings, column_unit, code)
    return clock.time, columns


def rate_without_time(
    raw: Mapping[str, Array], log: Log, choices: Choices
) -> tuple[float, str] | None:
    """The rate of the rows (Hz) and what tells it.

    That is a line above the table, a column that holds the time from one row to the next, or a
    velocity beside its position.
    """
    if stated := sample_rate_in(log.remarks):
        return stated[0], f"a line of the log states {stated[1]!r}"
    for name, values in raw.items():
        steps = values[np.isfinite(values)]
        if not says(name, "step of time") or len(steps) < 2 or steps.min() < 0:
            continue
        usual = float(np.median(steps))
        if not usual > 0 or np.median(np.abs(steps - usual)) > HALF * usual:
            continue
        unit = unit_of_time(name, choices.units.get(name) or log.units.get(name))
        unit = unit or unit_of_steps(np.cumsum(steps))[0]
        rate = float(f"{1.0 / (usual * si_factor(unit, quantity='time')):.4g}")
        return rate, f"{name!r} holds the usual time from one row to the next"
    return _rate_of_velocity(raw, log, choices)


def score_times(raw: Mapping[str, Array], log: Log, choices: Choices) -> dict[str, float]:
    """The score of each column that may be the time; a time by its name or unit may also wrap."""
    position = set(words_of(position_by_name(raw, choices)))
    clocks = {n: x for n, values in raw.items() if (x := _rising(n, values, log)) is not None}
    clocks = clocks or {n: x for n, x in raw.items() if _is_coarse_time(n, x, log)}
    scores: dict[str, float] = {}
    for name, stamps in clocks.items():
        is_called = is_called_time(name)
        scores[name] = score_of(
            "time",
            SurveyedColumn(name, stamps, stamps, choices.units.get(name)),
            left=1.0 if is_called else float(np.median(step_deviations(stamps))),
            is_called_a_clock=_is_called_clock(name),
            is_called_a_signal=not is_called and _names_signal(name, log, choices),
            counts_the_rows=counts_rows(stamps),
            is_the_first=not scores,
            has_words_of_the_position=is_called and not position.isdisjoint(words_of(name)),
        )
    return {name: score for name, score in scores.items() if score > -math.inf}


def _rising(name: str, values: Array, log: Log) -> Array | None:
    """The numbers of a column that rises, without gaps; of a time also one that wraps."""
    stamps = values[np.isfinite(values)]
    if rises(stamps):
        return stamps
    if not is_unit_of(log.units.get(name), "time") and likeness(name, "time") == 0:
        return None
    stamps = unwrap_stamps(stamps)[0]
    return stamps if rises(stamps) or are_out_of_order(stamps) else None


def why_time(name: str, columns: Sequence[str], raw: Mapping[str, Array], choices: Choices) -> str:
    """Why a column is the time, where its name alone does not say so; else "".

    columns: all that may be the time
    """
    first = columns[0]
    if not is_called_time(name):
        most = "the column that rises most evenly"
        return f"it is {'the first column that always rises' if name == first else most}"
    before = columns[: columns.index(name)]
    alike = [n for n in before if likeness(n, "time") == likeness(name, "time") > 0]
    beside = position_by_name(raw, choices)
    return f"of two clocks, {alike[0]!r} has no word of {beside!r}" if alike else ""


def is_called_time(name: str) -> bool:
    return likeness(name, "time") > 0 or _is_called_clock(name)


def _is_coarse_time(name: str, values: Array, log: Log) -> bool:
    """Whether a column is a time by its name or unit, in which many rows share a stamp."""
    timed = unit_of_time(name, log.units.get(name)) is not None
    if not timed and likeness(name, "time") < SURE_NAME:
        return False
    steps = np.diff(values[np.isfinite(values)])
    return bool(np.all(steps >= 0)) and int(np.count_nonzero(steps)) >= SEVERAL


def _names_signal(name: str, log: Log, choices: Choices) -> bool:
    """Whether a column that rises is a ramp or the way of a body, by its unit or its name.

    A letter tells nothing: "i" may count the rows.
    """
    words = words_of(name)
    unit = choices.units.get(name) or log.units.get(name) or unit_in_name(name)
    if words and unit != "counts" and any(is_unit_of(unit, q) for q in QUANTITIES):
        return True
    kinds = ("position", "velocity", "actuator_force")
    return any(len(w) > 1 and likeness(w, k) >= SURE_NAME for w in words for k in kinds)


def _is_called_clock(name: str) -> bool:
    """Whether a name consists only of a unit of time, or is that of a clock."""
    return is_unit_of(unit_of_text(bare_name(name)), "time") or says_only(name, "clock")


def _rate_of_velocity(
    raw: Mapping[str, Array], log: Log, choices: Choices
) -> tuple[float, str] | None:
    """The rate at which a velocity is the derivative of a position, Hz, and why; None: no other.

    Names or units say which are a position and a velocity.
    """
    known = {n: unit_in_log(n, log, choices) for n in raw}
    moving = {n: x for n, x in raw.items() if len(x) >= FEWEST and np.ptp(x) > 0}
    places, speeds = (
        [n for n in moving if likeness(n, q) > 0 or is_unit_of(known[n], q)]
        for q in ("position", "velocity")
    )
    best, pair = (0.0, DERIVATIVE), ("", "")
    for place, speed in product(places, (n for n in speeds if likeness(n, "position") == 0)):
        x, v, scale = moving[place], moving[speed], _scale(known[place], known[speed])
        if len(x) != len(v) or scale is None:
            continue
        whole = unwrap_column(x)
        factor, agree = derivative_factor(whole, v, 1 / ASSUMED)
        if agree > best[1] and has_both_signs(whole, v, 1 / ASSUMED):
            best, pair = (factor * scale, agree), (place, speed)
    if not best[0] > 0 or abs(best[0] - 1.0) < SMALL:
        return None
    rates = [float(f"{ASSUMED * best[0]:.{digits}g}") for digits in (1, 2, 3)]
    rate = next((r for r in rates if abs(r / (ASSUMED * best[0]) - 1.0) < ROUNDED), rates[-1])
    same = "" if all(map(known.get, pair)) else f", if it is in the unit of {pair[0]!r} per second"
    return rate, f"{pair[1]!r} is the derivative of {pair[0]!r} at this rate{same}"


def _scale(of_place: str | None, of_speed: str | None) -> float | None:
    """Units of a speed over those of a position, in SI; None: they do not belong together."""
    if of_place is None or of_speed is None:
        return 1.0
    for axis in ("revolute", "prismatic"):
        fits = measures(of_place, "position", axis) and measures(of_speed, "velocity", axis)
        if fits and of_place != "counts":
            speed = si_factor(of_speed, quantity="velocity", axis=axis)
            return speed / si_factor(of_place, quantity="position", axis=axis)
    return None


def counts_rows(x: Array) -> bool:
    """Whether a column is the number of each row."""
    return bool(np.all(np.diff(x[np.isfinite(x)]) == 1.0))


def position_by_name(raw: Mapping[str, Array], choices: Choices) -> str:
    """The column that is stated as the position, or most likely one by its name."""
    if choices.position is not None:
        return choices.position
    return max(raw, key=_likeness_of_position)


def _likeness_of_position(name: str) -> float:
    """How surely a name is that of a measured position; a set point is named alike."""
    return likeness(name, "position") - 0.6 * is_wanted(name)


def busiest_clock(log: Log, raw: Mapping[str, Array], choices: Choices) -> str:
    """The clock of the position, among several clocks of a log."""
    if choices.position is not None:
        return log.clocks[choices.position]
    scores = {n: _likeness_of_position(n.rpartition(".")[2]) for n in raw if n in log.clocks}
    best = max(scores, key=lambda n: (scores[n], len(raw[n])))
    return log.clocks[best]

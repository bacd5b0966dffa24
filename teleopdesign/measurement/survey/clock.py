"""The clock of a log: which column is the time, its unit, and all other columns on its grid."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...base.errors import ExperimentError, quote
from ...base.units import is_several_times, measures, si_factor
from ..column_names import (
    bare_name,
    is_wanted,
    likeness,
    unit_in_name,
    unit_of_text,
    words_of,
)
from ..doors._log import Log, bare_column, join_names
from ..encoder import is_most
from ..log_clock import OF_ANOTHER_CLOCK
from ..numbers_in_cells import holds_dates, numbers_of
from ..record_clock import clock_of
from ..row_places import are_out_of_order
from ..signed_numbers import sign_code_of
from ..stamps import seconds_since_first, unit_in_place_of, unit_of_steps, unwrap_stamps
from .candidate_clocks import (
    ASSUMED,
    busiest_clock,
    counts_rows,
    position_by_name,
    rate_of_velocity,
)
from .content import (
    SURE_NAME,
    Array,
    Choices,
    SurveyedColumn,
    is_unit_of,
    reasons,
    rises,
    unit_in_log,
)
from .remarks import sample_rate_in
from .roles import score_of
from .words import says, says_only

#: quantities whose units are not those of a time
QUANTITIES = ("position", "velocity", "force")
#: rows that are looked at
MOST = 60_000
#: least changes of stamps that many rows share, from which they tell the rate of the rows
FEWEST_CHANGES = 3
#: part of their median by which times from one row to the next may differ: more uneven ones are no
#: clock
UNEVEN = 0.5


def numeric_columns(log: Log, file: str) -> tuple[dict[str, Array], dict[str, str], Log]:
    """Columns of numbers or dates, by name; and the reason why each other column has none.

    returns: also the log with the unit of dates, and with single values ("gear = 30") as remarks
    """
    dated: list[str] = []
    remarks: list[str] = []
    raw: dict[str, Array] = {}
    unread: dict[str, str] = {}
    single = [name for name in log.names if log.names.count(name) == 1]
    try:
        # a text file is then read once, not once for each column
        together = log.read(dict.fromkeys(single, ""))
    except ExperimentError:
        together = {}
    for name in single:
        try:
            cells = together[name] if name in together else log.read({name: ""})[name]
            values = numbers_of(cells, name, file)
        except ExperimentError as problem:
            unread[name] = _without_name(str(problem), name, file)
            continue
        filled = np.isfinite(values)
        if len(values) > 1 and is_most(filled):
            raw[name] = values
            dated += [name] if holds_dates(cells) else []
        elif len(values) == 1:
            unread[name] = f"one value: {values[0]:g}"
            remarks.append(f"{bare_column(name)} = {values[0]:g}")
        else:
            finite = float(filled.mean()) if len(values) else 0.0
            more = f": {OF_ANOTHER_CLOCK}" if finite > 0 else ""
            unread[name] = f"numbers in {finite:.0%} of its rows{more}"
    if not raw or log.clocks and not log.clocks.keys() & raw.keys():  # or clocks alone
        whys = set(unread.values())
        if len(whys) == 1 and "found" in (why := whys.pop()):  # the same row of all columns
            raise ExperimentError(f"{file}: {why}")
        raise ExperimentError(
            f"{file}: found no column of numbers among {join_names(log.names)}{reasons(unread)}"
        )
    units = {**log.units, **dict.fromkeys(dated, "s")}
    return raw, unread, replace(log, units=units, remarks=(*log.remarks, *remarks))


def _without_name(message: str, column: str, file: str) -> str:
    """A message about a column, without the names of the file and of the column."""
    short = message.removeprefix(f"{file}: ").removeprefix("column ").removeprefix(quote(column))
    return short.lstrip(":, ")


def time_column(
    raw: Mapping[str, Array],
    log: Log,
    choices: Choices,
    guesses: dict[str, str],
    file: str,
) -> tuple[str | None, str]:
    """The name of the time column, None if there is none, and its unit."""
    if choices.sample_rate is not None:
        return None, "s"
    if choices.time is not None:
        name = choices.time
    elif log.clocks:
        name = busiest_clock(log, raw, choices)
    else:
        scores = _score_times(raw, log, choices)
        if not scores:
            guesses["sample_rate"] = (
                f"no column rises as a time does: the sample rate is assumed to be {ASSUMED:g} Hz"
            )
            return None, "s"
        name = max(scores, key=lambda n: scores[n])
        counted = name not in choices.units and counts_rows(raw[name])
        if not _is_called_time(name) and counted and sample_rate_in(log.remarks):
            return None, "s"
        if why := _why_time(name, list(scores), raw, choices):
            guesses["channels.time.column"] = f"{name!r} is read as the time: {why}"
    unit = choices.units.get(name) or _unit_of_time(name, log)
    if name in choices.units and is_several_times(choices.units[name]):
        return name, choices.units[name]
    if unit is None or not measures(unit, "time"):
        unit, why = unit_of_steps(raw[name])
        if why:
            counted = "channels.time.column" in guesses and counts_rows(raw[name])
            more = "; if it counts the rows: --sample-rate HZ" if counted else ""
            guesses["channels.time.unit"] = why + more
    elif name not in choices.units and (other := unit_in_place_of(unit, raw[name])):
        unit, guesses["channels.time.unit"] = other
    return name, unit


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
        if not usual > 0 or float(np.median(np.abs(steps - usual))) > UNEVEN * usual:
            continue
        unit = choices.units.get(name) or _unit_of_time(name, log)
        if unit is None or not measures(unit, "time"):
            unit, _ = unit_of_steps(np.cumsum(steps))
        rate = float(f"{1.0 / (usual * si_factor(unit, quantity='time')):.4g}")
        return rate, f"{name!r} holds the usual time from one row to the next"
    known = {n: choices.units.get(n) or log.units.get(n) or unit_in_log(n, log.names) for n in raw}
    return rate_of_velocity(raw, {n: u for n, u in known.items() if u is not None})


def _score_times(raw: Mapping[str, Array], log: Log, choices: Choices) -> dict[str, float]:
    """The score of each column that may be the time; a time by its name or unit may also wrap."""
    position = set(words_of(position_by_name(raw, choices)))
    clocks = {n: x for n, values in raw.items() if (x := _rising(n, values, log)) is not None}
    clocks = clocks or {n: x for n, x in raw.items() if _is_coarse_time(n, x, log)}
    scores: dict[str, float] = {}
    for name, stamps in clocks.items():
        is_called = _is_called_time(name)
        scores[name] = score_of(
            "time",
            SurveyedColumn(name, stamps, stamps, choices.units.get(name)),
            left=1.0 if is_called else _unevenness(stamps),
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


def _why_time(name: str, columns: Sequence[str], raw: Mapping[str, Array], choices: Choices) -> str:
    """Why a column is the time, where its name alone does not say so; else "".

    columns: all that may be the time
    """
    first = columns[0]
    if not _is_called_time(name):
        most = "the column that rises most evenly"
        return f"it is {'the first column that always rises' if name == first else most}"
    before = columns[: columns.index(name)]
    alike = [n for n in before if likeness(n, "time") == likeness(name, "time") > 0]
    beside = position_by_name(raw, choices)
    return f"of two clocks, {alike[0]!r} has no word of {beside!r}" if alike else ""


def _is_called_time(name: str) -> bool:
    return likeness(name, "time") > 0 or _is_called_clock(name)


def _unevenness(x: Array) -> float:
    """Median deviation of a column's steps from their median, over it; 1 where that is zero."""
    steps = np.diff(x)
    usual = float(np.median(steps))
    return float(np.median(np.abs(steps - usual))) / usual if usual > 0 else 1.0


def _is_coarse_time(name: str, values: Array, log: Log) -> bool:
    """Whether a column is a time by its name or unit, in which many rows share a stamp."""
    timed = is_unit_of(_unit_of_time(name, log), "time")
    if not timed and likeness(name, "time") < SURE_NAME:
        return False
    steps = np.diff(values[np.isfinite(values)])
    return bool(np.all(steps >= 0)) and int(np.count_nonzero(steps)) >= FEWEST_CHANGES


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


def _unit_of_time(name: str, log: Log) -> str | None:
    """The unit of a column if it is a time: of its file, in its name, or all of it: "Sekunden"."""
    unit = unit_of_text(bare_name(name))
    return (
        log.units.get(name)
        or unit_in_name(name, "time")
        or (unit if is_unit_of(unit, "time") else None)
    )


def _is_called_clock(name: str) -> bool:
    """Whether a name consists only of a unit of time, or is that of a clock."""
    return is_unit_of(unit_of_text(bare_name(name)), "time") or says_only(name, "clock")


def duration_of(
    raw: Mapping[str, Array], time_name: str | None, unit: str, choices: Choices
) -> float:
    """Time from the first to the last row of the whole log, s."""
    if time_name is None:
        return (max(map(len, raw.values())) - 1) / (choices.sample_rate or ASSUMED)
    stamps = raw[time_name] * si_factor(unit, quantity="time")
    return float(np.nanmax(seconds_since_first(stamps)))


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
    if time_name is None:
        count = max(map(len, raw.values()))
        stamps = np.arange(count) / (choices.sample_rate or ASSUMED)
    else:
        stamps = raw[time_name] * si_factor(unit, quantity="time")
    beside_time = {n: x for n, x in raw.items() if len(x) == len(stamps)}
    rows = np.flatnonzero(np.isfinite(stamps))[:MOST]
    origin = stamps[rows[0]]
    clock = clock_of(
        stamps[rows] - origin, (slice(0, len(rows)),), np.zeros(len(rows), dtype=bool), file
    )
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
        column_unit = choices.units.get(name) or log.units.get(name)
        column_unit = column_unit or unit_in_log(name, log.names)
        # the counter of a position wraps, which is the same as a sign
        is_counter = likeness(name, "position") >= SURE_NAME and not is_wanted(name)
        code = None if is_counter else sign_code_of(x[fine])
        readings = x[fine] if code is None else code.decode(x[fine])
        grid = np.interp(clock.time, at[fine], readings)
        columns[name] = SurveyedColumn(name, grid, readings, column_unit, code)
    return clock.time, columns

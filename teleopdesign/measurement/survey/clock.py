"""The clock of a log: its columns of numbers, the time and its unit, and all on an even grid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...base.errors import ExperimentError, quote
from ...base.units import is_several_times, si_factor
from ..column_names import is_wanted, likeness
from ..doors._cells import holds_dates, numbers_of
from ..doors._log import Log, bare_column, join_names
from ..encoder import Array, is_most, sign_code_of
from ..log_clock import OF_ANOTHER_CLOCK
from ..record_clock import clock_of
from ..repeated_rows import rows_between_readings
from ..spikes import lost_zeros
from ..stamps import seconds_since_first, unit_of_steps, unit_of_time
from .content import ASSUMED, SURE_NAME, Choices, SurveyedColumn, rises, sample_rate_in
from .refusals import reasons
from .roles import unit_in_log
from .time_role import (
    busiest_clock,
    counts_rows,
    is_called_time,
    score_times,
    why_time,
)

#: rows that are looked at
MOST = 60_000
#: units in which load cells are read, and those of the weight that acts
WEIGHTS = {"kg": "kgf"}


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
            why = str(problem).removeprefix(f"{file}: ").removeprefix("column ")
            unread[name] = why.removeprefix(quote(name)).lstrip(":, ")
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
        scores = score_times(raw, log, choices)
        if not scores:
            guesses["sample_rate"] = (
                f"no column rises as a time does: the sample rate is assumed to be {ASSUMED:g} Hz"
            )
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
        column_unit = WEIGHTS.get(column_unit or "", column_unit)
        # the counter of a position wraps, which is the same as a sign
        is_position = likeness(name, "position") >= SURE_NAME and not is_wanted(name)
        fine &= ~lost_zeros(x) if is_position else True
        code = None if is_position else sign_code_of(x[fine])
        readings = x[fine] if code is None else code.decode(x[fine])
        grid = np.interp(clock.time, at[fine], readings)
        columns[name] = SurveyedColumn(name, grid, readings, column_unit, code)
    return clock.time, columns

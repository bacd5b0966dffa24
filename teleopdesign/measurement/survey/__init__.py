"""Proposal of a log's channels: which column is which quantity, in which unit, and what is a guess.

Names come first. Where names do not decide, physics does: a velocity is the derivative of a
position, a force balances inertia and friction of the motion, and friction takes energy out, which
decides the sign. What neither names nor physics decide is marked as a guess.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from ...base.errors import ExperimentError, did_you_mean
from ...base.units import is_several_times, is_unit, parse_unit
from ..channel import BODY_QUANTITIES
from ..column_names import WORDS, as_unit, unit_in_name, words_of
from ..doors._cells import numbers_of
from ..doors._log import Log, join_names
from ..doors.topics import are_quantities
from ..encoder import Array
from ..limits import FEWEST
from ..record_clock import segments_of
from ..stamps import unwrap_stamps
from .clock import (
    WEIGHTS,
    counts_rows,
    duration_of,
    interpolate_columns,
    rate_without_time,
    time_column,
)
from .content import ASSUMED, NONE, Choices, Survey, SurveyedColumn, numeric_columns
from .derivative import wrap_of
from .forces import describe_forces
from .position import find_position
from .position_entry import axis_of, describe_position
from .refusals import unused_columns

__all__ = [
    "Choices",
    "Survey",
    "SurveyedColumn",
    "require_same_columns",
    "spans_of",
    "survey_log",
    "survey_logs",
]

#: units that a misspelt one may mean
UNITS = (
    *("s", "ms", "us", "ns", "m", "mm", "um", "rad", "deg", "turns", "counts"),
    *("m/s", "mm/s", "rad/s", "deg/s", "rpm", "N", "mN", "N*m", "Nm", "mN*m", "A", "mA", "V"),
)
#: part of a single log that is fitted; the rest is the check record
FIT_PART = 0.6
#: part of a log by which a cut moves to lie between two trials
NEAR_CUT = 0.25


def survey_log(log: Log, file: str, choices: Choices) -> Survey:
    """Propose the channels of one log.

    choices: what the user states
    raises ExperimentError: no position, no force among the columns, or a column that is not there
    """
    raw, unread, log = numeric_columns(log, file)
    choices = replace(choices, units={n: as_unit(u) for n, u in choices.units.items()})
    _check_choices(choices, raw, unread, file)
    guesses: dict[str, str] = {}
    time_name, unit = time_column(raw, log, choices, guesses)
    if time_name is not None:
        raw[time_name], _ = unwrap_stamps(raw[time_name])
    elif choices.sample_rate is None and (rate := rate_without_time(raw, log, choices)):
        choices = replace(choices, sample_rate=rate[0])
        guesses["sample_rate"] = f"{rate[0]:g} Hz: no column rises as a time does, and {rate[1]}"
    try:
        time, columns = interpolate_columns(raw, log, time_name, unit, choices, file)
    except ExperimentError as problem:
        few = min(map(len, raw.values())) < FEWEST
        how = _how_clock_was_read(guesses, time_name, unit, choices)
        raise ExperimentError(f"{problem}{'' if few else how}") from None
    duration = duration_of(raw, time_name, unit, choices)
    # numbers of rows are no signal, though a scope calls them "X"
    signals = {n: c for n, c in columns.items() if time_name or not counts_rows(c.readings)}
    survey = Survey("", {}, duration, guesses, time, signals, unread=unread, remarks=log.remarks)
    if time_name is not None:
        survey.channels["time"] = {"column": time_name, "unit": unit}
    else:
        survey.channels["sample_rate"] = {"value": choices.sample_rate or ASSUMED, "unit": "Hz"}
    survey.is_stated = choices.states_all
    name_trials(survey, raw)
    survey.columns = longest_trial(survey)
    position, velocity = find_position(survey, choices, file)
    survey.axis = axis_of(survey, position, choices)
    describe_position(survey, position, velocity, choices)
    describe_forces(survey, position, velocity, choices, file)
    _units_in_use(survey, choices, file)
    _doubt_units(survey, log, choices)
    survey.unused = unused_columns(log, raw, survey)
    survey.columns = columns
    return survey


def survey_logs(logs: Sequence[Log], files: Sequence[str], choices: Choices) -> Survey:
    """Propose the channels that several logs of one experiment share; files: their names.

    The first log that tells position and force is surveyed. If its position does not wrap and that
    of a later one does, that one is: the readings of a slow run tell nothing of the wrap.
    """
    problems = []
    for log, file in zip(logs, files, strict=True):
        try:
            survey = survey_log(log, file, choices)
        except ExperimentError as problem:
            problems.append(problem)
        else:
            break
    else:
        raise problems[0]
    position = survey.channels["position"]
    if "unwrap" in position:
        return survey
    name = position["column"]
    for log, file in zip(logs[1:], files[1:], strict=True):
        x = numbers_of(log.read({name: ""})[name], name, file)
        finite = x[np.isfinite(x)]
        if len(finite) > 1 and wrap_of(finite) is not None:
            return survey_log(log, file, choices)
    return survey


def _how_clock_was_read(
    guesses: Mapping[str, str], time_name: str | None, unit: str, choices: Choices
) -> str:
    """What was guessed of the time, or its unit, as the end of a message on a useless clock."""
    if guesses:
        option = "--time COLUMN, --unit COLUMN=UNIT or --sample-rate HZ states it"
        return f"; {'; '.join(guesses.values())}: {option}"
    if time_name is None or unit == "s" or time_name in choices.units:
        return ""
    return f"; {time_name!r} is read in {unit}: --unit {time_name + '=UNIT'!r} states another unit"


def _check_choices(
    choices: Choices, raw: Mapping[str, Array], unread: Mapping[str, str], file: str
) -> None:
    """Refuse columns that the log does not have, texts that are no units, impossible numbers."""
    keys = ("time", "position", "actuator_force", "interaction_force")
    stated = {key: getattr(choices, key) for key in keys}
    columns = [(key, name) for key, name in stated.items() if name not in (None, NONE)]
    for key, name in (*columns, *(("unit", name) for name in choices.units)):
        if name not in raw:
            why = f"column {name!r}: {unread[name]}" if name in unread else f"no column {name!r}"
            raise ExperimentError(
                f"{file}: {key}: {why}, found {join_names(raw)}{did_you_mean(name, raw)}"
            )
    for column, unit in choices.units.items():
        if unit != "counts" and not is_unit(unit) and not is_several_times(unit):
            raise ExperimentError(
                f"{file}: unit of {column!r}: found {unit!r}, expected a unit such as "
                f'"deg", "mm", "N*m" or "A", or "125 us" for the ticks of a clock'
                f"{did_you_mean(unit, UNITS)}"
            )
    for key, expected in (
        ("sample_rate", "more than 0 Hz"),
        ("counts_per_turn", "more than 0"),
        ("gear_ratio", "any other number"),
    ):
        value = getattr(choices, key)
        if value is None:
            continue
        # a device with a sample rate of 0 Hz or a gear ratio of 0 has no motion
        if not math.isfinite(value) or value == 0 or (value < 0 and key != "gear_ratio"):
            raise ExperimentError(f"{file}: {key}: found {value:g}, expected {expected}")


def _units_in_use(survey: Survey, choices: Choices, file: str) -> None:
    """Refuse a unit that the user chose for a column and that does not suit its quantity."""
    for key, entry in survey.channels.items():
        column = entry.get("column")
        unit = choices.units.get(column) if isinstance(column, str) else None
        if unit is not None and unit != entry.get("unit"):
            noun = "force" if key.endswith("force") else key
            on_axis = "" if key == "time" else f" on a {survey.axis} axis"
            raise ExperimentError(
                f"{file}: unit of {column!r}: found {unit!r}, expected one of a {noun}"
                f"{on_axis}, such as {entry.get('unit')!r}"
            )


def _doubt_units(survey: Survey, log: Log, choices: Choices) -> None:
    """Mark the unit of a channel as a guess where the log states another one for its column."""
    for key in ("position", "velocity", "actuator_force", "interaction_force"):
        entry = survey.channels.get(key, {})
        if (column := entry.get("column")) is None or column in choices.units:
            continue
        unit, named = entry["unit"], unit_in_name(column, BODY_QUANTITIES[key], survey.axis)
        written, why = log.units.get(column) or unit_in_name(column), f"channels.{key}.unit"
        if written in WEIGHTS and unit == WEIGHTS[written]:
            survey.guesses[why] = f"{unit}: {column!r} in {written} is read as the weight that acts"
        elif column in log.units and named and not _are_same(named, unit):
            survey.guesses[why] = f"{unit}: a row of units states it, the name {column!r} another"


def _are_same(one: str, other: str) -> bool:
    """Whether two texts mean the same unit."""
    return one == other or "counts" not in (one, other) and parse_unit(one) == parse_unit(other)


def spans_of(
    duration: float, trials: Sequence[float] = ()
) -> tuple[tuple[float, float], tuple[float, float]]:
    """(begin, end) in s of the fit record and of the check record in one log.

    trials: where trials begin: the log is cut at one of them, if any lies near the usual cut
    """
    usual = FIT_PART * duration
    near = [t for t in trials if abs(t - usual) < NEAR_CUT * duration]
    cut = float(f"{min(near, key=lambda t: abs(t - usual), default=usual):.4g}")
    return (0.0, cut), (cut, math.floor(duration) + 1.0)


def require_same_columns(logs: Sequence[Log], files: Sequence[str]) -> None:
    """Raise an ExperimentError where a later log lacks a column of the first.

    So it does where the files hold one quantity each, of the same joints.
    """
    tables = [PurePath(file).name.split(".")[0] for file in files]
    if are_quantities(tables, [log.names for log in logs]):
        raise ExperimentError(
            f"{', '.join(files)}: found the same columns in files that are called by different "
            "quantities, expected several runs; for one run, put them into a folder and give it"
        )
    for log, file in zip(logs[1:], files[1:], strict=True):
        missing = [n for n in logs[0].names if n not in log.names]
        if missing:
            raise ExperimentError(
                f"{file}: has no column {missing[0]!r}, which {files[0]} has; if both are parts of "
                "one run, put them into a folder and give the folder"
            )


def trial_column(raw: Mapping[str, Array]) -> str | None:
    """The column that numbers trials, by its name and by whole numbers that seldom change."""
    for name, values in raw.items():
        if not set(WORDS["segment"]).intersection(words_of(name)):
            continue
        changes = int(np.count_nonzero(np.diff(values)))
        # trials with fewer rows than a record, on average, are none: what changes more is a signal
        if np.all(values == np.round(values)) and 0 < changes * FEWEST < len(values):
            return name
    return None


def name_trials(survey: Survey, raw: Mapping[str, Array]) -> None:
    """Take the column that numbers trials as that of segments, and say where trials begin."""
    name = trial_column(raw)
    if name is None:
        return
    survey.channels["segment"] = {"column": name}
    changes = int(np.count_nonzero(np.diff(raw[name])))
    survey.notes.append(f"{name!r} numbers {changes + 1} trials: each is a segment")
    # the pause between two trials is interpolated, its label too: no two rows there are alike
    starts = [rows.start for rows in _trials(survey) if rows.stop - rows.start > 1]
    survey.trials = tuple(float(survey.time[k]) for k in starts[1:])


def longest_trial(survey: Survey) -> dict[str, SurveyedColumn]:
    """The columns in the longest trial; all rows, where the log has no trials.

    Between two trials a position may leap: of such a leap no physics tells signs or units.
    """
    longest = max(_trials(survey), key=lambda rows: rows.stop - rows.start)
    return {n: replace(c, values=c.values[longest]) for n, c in survey.columns.items()}


def _trials(survey: Survey) -> tuple[slice, ...]:
    name = survey.channels.get("segment", {}).get("column")
    column = survey.columns.get(name) if name else None
    return segments_of(None if column is None else column.values, len(survey.time))

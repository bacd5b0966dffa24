"""A folder of tables that one run wrote: the log of a drive, the log of a force sensor.

Each table keeps its clock, as each topic of a bag does. The name of the table is put before the
names of its columns ("drive.position"). Of tables whose columns are the same joints, one table for
each quantity, it is put after them ("joint_2.torque").
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import ExperimentError
from ...base.units import si_factor
from ..column_names import likeness
from ..encoder import Array
from ..stamps import share_time, unit_of_steps, unit_of_time, unwrap_stamps
from ._cells import numbers_of
from ._log import Log, join_names


def open_folder(
    folder: Path, file: str, tables: Sequence[Path], open_one: Callable[[Path, str], Log]
) -> Log:
    """Open several tables as one log.

    tables: the files of the folder that are tables;  open_one: function that opens one of them
    raises ExperimentError: tables with the same columns, a table without a time, or tables whose
        times do not overlap
    """
    stems = [t.name.split(".")[0] for t in tables]
    names = stems if len(set(stems)) == len(stems) else [t.name for t in tables]
    logs = {n: open_one(t, f"{file}/{t.name}") for n, t in zip(names, tables, strict=True)}
    if are_quantities(names, [log.names for log in logs.values()]):
        logs = dict(zip(_without_shared_words(names), logs.values(), strict=True))
        name_of = _field_name
    else:
        _refuse_same_columns(logs, folder, [t.name for t in tables])
        name_of = _topic_name
    time_of = {name: _time_column(log, f"{file}/{name}") for name, log in logs.items()}
    seconds = {n: _seconds_of(log, time_of[n], f"{file}/{n}") for n, log in logs.items()}
    _require_shared_time(seconds, file)
    origin = min(float(np.nanmin(s)) for s in seconds.values())
    columns = {name_of(n, c): (n, c) for n, log in logs.items() for c in log.names}
    units = {name_of(n, c): u for n, log in logs.items() for c, u in log.units.items()}
    units |= {name_of(n, time): "s" for n, time in time_of.items()}

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        out: dict[str, Any] = {}
        for name, log in logs.items():
            in_table = {w: columns[w][1] for w in wanted if columns[w][0] == name}
            here = {column: wanted[w] for w, column in in_table.items()}
            values = log.read({c: ch for c, ch in here.items() if c != time_of[name]})
            out |= {name_of(name, c): v for c, v in values.items()}
            if time_of[name] in here:
                out[name_of(name, time_of[name])] = seconds[name] - origin
        return out

    clocks = {w: name_of(n, time_of[n]) for w, (n, c) in columns.items() if c != time_of[n]}
    notes = [f"{n}: {note}" for n, log in logs.items() for note in log.notes]
    notes.append(f"{len(logs)} tables, each with its own clock: {join_names(logs)}")

    def left_out() -> tuple[str, ...]:
        return tuple(f"{n}: {note}" for n, log in logs.items() for note in log.left_out())

    return Log(tuple(columns), read, units, tuple(notes), clocks, left_out)


def are_quantities(tables: Sequence[str], headers: Sequence[tuple[str, ...]]) -> bool:
    """Whether tables of the same joints hold one quantity each: "positions.csv", "efforts.csv".

    Columns that are called position and force themselves belong to several runs, whatever the
    files are called.

    tables: names of the files without their endings;  headers: the columns of each
    """
    one = len(tables) > 1 and len(set(headers)) == 1
    return one and _name_both(_without_shared_words(tables)) and not _name_both(headers[0])


def _name_both(names: Iterable[str]) -> bool:
    """Whether some of the names are that of a position, and others that of a force."""
    kinds = (("position",), ("actuator_force", "interaction_force"))
    of_names = [{k for k in kinds if any(likeness(n, q) > 0 for q in k)} for n in names]
    return all({k} in of_names for k in kinds)


def _topic_name(table: str, column: str) -> str:
    return f"{table}.{column}"


def _field_name(table: str, column: str) -> str:
    """The name of a joint's quantity, as a field of a struct: "joint_2.torque"; of its clock."""
    return _topic_name(table, column) if likeness(column, "time") else f"{column}.{table}"


def _without_shared_words(names: Sequence[str]) -> list[str]:
    """Names without the words at their ends that all share: "force_kN_test3" -> "force_kN".

    The names stay as they are where one would lose all its words, or two would be the same.
    """
    words = [name.split("_") for name in names]
    for end in (0, -1):
        while all(words) and len({w[end] for w in words}) == 1:
            words = [w[1:] if end == 0 else w[:-1] for w in words]
    shorter = ["_".join(w) for w in words]
    return shorter if all(shorter) and len(set(shorter)) == len(names) > 1 else list(names)


def _refuse_same_columns(logs: Mapping[str, Log], folder: Path, files: Sequence[str]) -> None:
    headers = [log.names for log in logs.values()]
    if len(headers) > 1 and len(set(headers)) < len(headers):
        paths = shlex.join(str(folder / f) for f in files)
        raise ExperimentError(
            f"{folder}: found tables of the same columns, expected parts of one run; for several "
            f"runs: teleopdesign new {paths}"
        )


def _time_column(log: Log, file: str) -> str:
    best = max(log.names, key=lambda name: likeness(name, "time"))
    if likeness(best, "time") == 0.0:
        raise ExperimentError(
            f"{file}: found no column that is called time among {join_names(log.names)}, expected "
            "one in each table of a folder, or one table with all columns"
        )
    return best


def _require_shared_time(seconds: Mapping[str, Array], file: str) -> None:
    ends = {name: (float(np.nanmin(s)), float(np.nanmax(s))) for name, s in seconds.items()}
    if not share_time(ends.values()):
        spans = ", ".join(f"{n} from {b:.9g} to {e:.9g} s" for n, (b, e) in ends.items())
        raise ExperimentError(
            f"{file}: found tables that do not run at the same time ({spans}), expected one clock "
            "for all; shift the time of one, or log a common time"
        )


def _seconds_of(log: Log, column: str, file: str) -> Array:
    """The time stamps of a table in s, from the same instant for all tables of one logger."""
    values = np.asarray(log.read({column: "channels.time"})[column])
    if values.dtype.kind == "M":
        return np.asarray((values - np.datetime64(0, "s")) / np.timedelta64(1, "ns") * 1e-9)
    stamps = (
        values.reshape(-1).astype(np.float64)
        if values.dtype.kind in "iu"  # as floats, nanoseconds since 1970 are exact to 256 ns
        else numbers_of(values, column, file)
    )
    unit = unit_of_time(column, log.units.get(column)) or unit_of_steps(stamps)[0]
    return np.asarray(unwrap_stamps(stamps)[0] * si_factor(unit, quantity="time"))

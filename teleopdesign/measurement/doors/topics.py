"""Logs whose parts have clocks of their own: bags of ROS, and folders of tables.

Bags are those of ROS 1 (.bag) and ROS 2 (.db3, .mcap, a folder with metadata.yaml). A column is
TOPIC.FIELD ("/ft.wrench.force.z"), one for each number. A `sensor_msgs/JointState`, and what the da
Vinci Research Kit publishes in the same form, name their joints: "/joint_states.elbow.position".
Each topic has its time stamps in "TOPIC.stamp", in s from the beginning of the bag: the stamps of
its headers, or else the times of recording.

The tables of a folder are those that one run wrote: the log of a drive, the log of a force sensor.
The name of the table is put before the names of its columns ("drive.position"). Of tables whose
columns are the same joints, one table for each quantity, it is put after them ("joint_2.torque").
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import LONGEST, ExperimentError, quote
from ...base.units import si_factor
from ..column_names import likeness
from ..encoder import Array
from ..stamps import share_time, unit_of_steps, unit_of_time, unwrap_stamps
from ._cells import numbers_of
from ._log import MOST_FIELDS, Log, join_names, optional, refuse_damage, refuse_size
from .json_records import add_row, fields_of

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
STAMP = "stamp"
_WRITTEN = "written"
#: s between the stamp in a header and the time of recording, from which they are different clocks
_OTHER_CLOCK = 10.0


def is_bag(path: Path) -> bool:
    """Whether a path is a bag: a bag file, or the folder that ROS 2 writes."""
    if path.is_dir():
        return (path / "metadata.yaml").is_file()
    return path.name.lower().endswith((".bag", ".mcap", ".db3"))


def open_bag(path: Path, file: str) -> Log:
    """Open a bag; every message of every topic with numbers is read once."""
    anyreader = optional("rosbags.highlevel", file, "ros")
    topics: dict[str, dict[str, list[float]]] = {}
    source = path
    if path.name.lower().endswith(".db3") and (path.parent / "metadata.yaml").is_file():
        source = path.parent
    with refuse_damage("bag", file):
        _check_definitions(source, file)
        with anyreader.AnyReader([source]) as reader:
            refuse_size(reader.message_count, file)
            begin = reader.start_time
            chosen = [c for c in reader.connections if c.msgcount > 1]
            for connection, written, raw in reader.messages(connections=chosen):
                message = reader.deserialize(raw, connection.msgtype)
                _append(topics.setdefault(connection.topic, {}), message, written, begin)
    columns = _columns(topics)
    if not columns:
        raise ExperimentError(
            f"{file}: found no topic with numbers, but {join_names(topics) or 'no messages'}"
        )
    clocks = {f"{t}.{name}": f"{t}.{STAMP}" for t, rows in topics.items() for name in rows}
    clocks = {name: clock for name, clock in clocks.items() if name in columns}

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        return {name: columns[name] for name in wanted}

    return Log(tuple(columns), read, dict.fromkeys(clocks.values(), "s"), (), clocks)


def _check_definitions(source: Path, file: str) -> None:
    """Refuse names in message definitions that are no plain words: rosbags makes code of them.

    raises ExperimentError: any other name, or a constant that is neither number nor text
    """
    readers = [optional(f"rosbags.rosbag{k}", file, "ros") for k in (1, 2)]
    typesys = optional("rosbags.typesys", file, "ros")
    with readers[source.suffix != ".bag"].Reader(source) as reader:
        for connection in reader.connections:
            _check_type_name(connection.msgtype, file)
            text, written = connection.msgdef.data, connection.msgdef.format.name
            if written == "NONE":  # of old bags, whose types rosbags knows
                continue
            if written != "MSG":
                raise ExperimentError(f"{file}: found definitions in {written}, expected in MSG")
            types = typesys.get_types_from_msg(text, connection.msgtype)
            for name, (constants, its_fields) in types.items():
                _check_type_name(name, file)
                for field, kind in its_fields:
                    _check_field(field, kind, file)
                for constant, kind, value in constants:
                    _check_field(constant, kind, file)
                    if type(value) not in (bool, int, float, str):
                        raise ExperimentError(f"{file}: constant {constant}: expected a number")


def _check_type_name(name: str, file: str) -> None:
    """Refuse a type name that is not words joined by slashes: "sensor_msgs/msg/JointState"."""
    if not (0 < len(name) <= LONGEST and all(map(_WORD.fullmatch, name.split("/")))):
        raise ExperimentError(
            f"{file}: found a message type {quote(name)}, expected words joined by slashes, such "
            "as sensor_msgs/msg/JointState"
        )


def _check_field(name: str, kind: Any, file: str) -> None:
    """Refuse a field whose name is no word, or whose type holds anything but words and sizes."""
    if not (len(name) <= LONGEST and _WORD.fullmatch(name)):
        raise ExperimentError(f"{file}: found a field {quote(name)}, expected a word")
    parts = [kind]
    while parts:
        part = parts.pop()
        if isinstance(part, tuple | list):
            parts += part
        elif isinstance(part, str):
            _check_type_name(part, file)
        elif not isinstance(part, int):  # a number is the kind of node
            raise ExperimentError(f"{file}: field {name}: found {type(part).__name__} as its type")


def _append(rows: dict[str, list[float]], message: Any, written: int, begin: int) -> None:
    """Append the numbers of one message to the columns of its topic; NaN where it has none."""
    pairs = fields_of(message, lambda k: f"[{k}]")
    plain = ((n, float(x)) for n, x in pairs if isinstance(x, bool | int | float | np.number))
    numbers = dict(islice(plain, MOST_FIELDS))
    header = getattr(getattr(message, "header", None), "stamp", None)
    times = dict.fromkeys((STAMP, _WRITTEN), (written - begin) * 1e-9)
    if header is not None and (header.sec or header.nanosec):
        stamp = int(header.sec) * 1_000_000_000 + int(header.nanosec) - begin
        times[STAMP] = stamp * 1e-9
    new = [name for name in numbers if name not in rows]
    for name in new[max(0, MOST_FIELDS - len(rows.keys() - times.keys())) :]:
        del numbers[name]
    add_row(rows, (numbers | times).items(), len(rows.get(STAMP, ())), np.nan)


def _columns(topics: Mapping[str, Mapping[str, list[float]]]) -> dict[str, Array]:
    late = [np.median(np.subtract(r[STAMP], r[_WRITTEN])) for r in topics.values()]
    clock = _WRITTEN if any(abs(x) > _OTHER_CLOCK for x in late) else STAMP
    columns = {}
    for topic, rows in topics.items():
        length = len(rows[STAMP])
        if len(rows) <= 2:  # nothing but both times
            continue
        columns[f"{topic}.{STAMP}"] = np.array(rows[clock])
        for name in rows:
            if name not in (STAMP, _WRITTEN):
                values = np.full(length, np.nan)
                values[: len(rows[name])] = rows[name]
                columns[f"{topic}.{name}"] = values
    return columns


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
    of_joints = are_quantities(names, [log.names for log in logs.values()])
    if of_joints:
        logs = dict(zip(_without_shared_words(names), logs.values(), strict=True))
    else:
        _refuse_same_columns(logs, folder, [t.name for t in tables])

    def name_of(table: str, column: str) -> str:
        """ "drive.position"; of a joint's quantity as a field of a struct: "joint_2.torque"."""
        is_field = of_joints and not likeness(column, "time")
        return f"{column}.{table}" if is_field else f"{table}.{column}"

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

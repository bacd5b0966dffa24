"""ROS 1 bags (.bag) and ROS 2 bags (.db3, .mcap, a folder with metadata.yaml): one column a number.

A column is TOPIC.FIELD ("/ft.wrench.force.z"). A `sensor_msgs/JointState`, and what the da Vinci
Research Kit publishes in the same form, name their joints: "/joint_states.elbow.position". Each
topic has its time stamps in "TOPIC.stamp", in s from the beginning of the bag: the stamps of its
headers, or else the times of recording.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import LONGEST, ExperimentError, quote
from ..encoder import Array
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

"""Times in two columns: whole seconds, and the part of the second beside them.

    header.stamp.sec, header.stamp.nanosec, position
    1736150000,       998123456,            0.10
    1736150001,         2123499,            0.11

Clocks of operating systems and of ROS count in this way, in ns or us, and loggers write a time of
day beside its ms. Either column alone would be a wrong time: the seconds stand still, and their
part is set back each second.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...base.errors import ExperimentError
from ...base.units import si_factor
from ._log import Array, Log

#: last words of the names of whole seconds, and of their part with its unit
SECONDS = frozenset("s sec secs second seconds".split())
PARTS = {
    **dict.fromkeys("ns nsec nsecs nanosec nanosecs nanosecond nanoseconds".split(), "ns"),
    **dict.fromkeys("us usec usecs microsec microsecs microsecond microseconds".split(), "us"),
    **dict.fromkeys("ms msec msecs millisec millisecs millisecond milliseconds".split(), "ms"),
}
#: part of a second that the parts must reach, where no name tells that they are parts
REACH = 0.5


def with_whole_time(log: Log, file: str, *, named: bool = True) -> Log:
    """The log with one column in place of the two parts of a time.

    named: False: no name of a column says what it is
    """
    if log.clocks:
        return log
    for first, second, units in _candidates(log.names) if named else _neighbours(log.names):
        try:
            columns = _numbers(log, first, second, file)
        except ExperimentError:  # texts: the message belongs to the column that is wanted
            continue
        for unit in units:
            if are_parts_of_time(*columns, per_second=1.0 / si_factor(unit, quantity="time")):
                return _with_joined(log, file, (first, second, unit))
    return log


def _with_joined(log: Log, file: str, parts: tuple[str, str, str]) -> Log:
    first, second, unit = parts
    stem = _stem(first)[0] if _stem(first)[1] in SECONDS else f"{first} + {second}"
    name = stem or "time"
    name = f"{first} + {second}" if name in log.names else name

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        out = dict(log.read({w: channel for w, channel in wanted.items() if w != name}))
        if name in wanted:
            whole, part = _numbers(log, first, second, file)
            out[name] = whole + si_factor(unit, quantity="time") * part
        return out

    note = f"a time in two columns: {first!r} in s, and {second!r} in {unit}"
    return replace(
        log,
        names=(name, *(n for n in log.names if n not in (first, second))),
        read=read,
        units={**log.units, name: "s"},
        notes=(*log.notes, note),
    )


def are_parts_of_time(whole: Array, part: Array, *, per_second: float) -> bool:
    """Whether two columns (n,) are the seconds of a time and the parts of these seconds."""
    from ..wrapped_stamps import unwrap_stamps

    filled = np.isfinite(whole) & np.isfinite(part)
    whole, part = unwrap_stamps(whole[filled])[0], part[filled]
    if len(whole) < 2 or not np.array_equal(whole, np.round(whole)):
        return False
    if part.min() < 0 or part.max() >= per_second or part.max() < REACH * per_second:
        return False
    turns = np.diff(whole)
    return bool(turns.any() and np.all((turns >= 0) & ((turns > 0) | (np.diff(part) >= 0))))


def _numbers(log: Log, first: str, second: str, file: str) -> tuple[Array, Array]:
    from ..numbers_in_cells import numbers_of

    columns = log.read({first: "channels.time", second: "channels.time"})
    return numbers_of(columns[first], first, file), numbers_of(columns[second], second, file)


def _candidates(names: tuple[str, ...]) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Columns of one stem whose last words are a second and a part of it: "stamp.sec".

    A column called "ms" alone may hold the part of a time of day beside it, without fractions.
    """
    from ..column_names import likeness

    parts = [name for name in names if _stem(name)[0] == "" and _stem(name)[1] in PARTS]
    if len(parts) == 1:
        for first in (name for name in names if likeness(name, "time") > 0.0):
            yield first, parts[0], (PARTS[_stem(parts[0])[1]],)
    for first in names:
        stem, word = _stem(first)
        if word not in SECONDS:
            continue
        for second in names:
            if second != first and _stem(second)[0] == stem and _stem(second)[1] in PARTS:
                yield first, second, (PARTS[_stem(second)[1]],)


def _neighbours(names: tuple[str, ...]) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """The first two columns, where no name tells more."""
    if len(names) > 2:
        yield names[0], names[1], ("ns", "us")


def _stem(name: str) -> tuple[str, str]:
    """A name without its last word, and this word in lower case: ("header.stamp", "nanosec")."""
    end = max(name.rfind(sign) for sign in "._ /")
    return name[: max(end, 0)].rstrip("._ /"), name[end + 1 :].strip("()[]").lower()

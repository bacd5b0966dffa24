"""Tables with a time in two columns: whole seconds, and the part of the second beside them.

    header.stamp.sec, header.stamp.nanosec, position
    1736150000,       998123456,            0.10
    1736150001,         2123499,            0.11

Clocks of operating systems and of ROS count in this way, in ns or us, and loggers write a time of
day beside its ms.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from ....base.units import si_factor
from ...column_names import likeness
from ...encoder import Array
from ...limits import HALF
from ...stamps import unwrap_stamps
from ._table import CellTable, LongSignal, LongTable

#: last words of the names of whole seconds, and of their part with its unit
SECONDS = frozenset("s sec secs second seconds".split())
PARTS = {
    **dict.fromkeys("ns nsec nsecs nanosec nanosecs nanosecond nanoseconds".split(), "ns"),
    **dict.fromkeys("us usec usecs microsec microsecs microsecond microseconds".split(), "us"),
    **dict.fromkeys("ms msec msecs millisec millisecs millisecond milliseconds".split(), "ms"),
}


def two_part_time(table: CellTable) -> LongTable | None:
    """Whole seconds, and the part of the second beside them: "stamp.sec, stamp.nanosec".

    Either column alone would be a wrong time: the seconds stand still, and their part is set back
    each second.
    """
    for first, second, units in _parts_of_times(table.names):
        whole, part = (table.numeric.get(n) for n in (first, second))
        if whole is None or part is None:
            continue
        for unit in units:
            second_in = si_factor(unit, quantity="time")
            if not are_parts_of_time(whole, part, per_second=1.0 / second_in):
                continue
            stem = _stem(first)[0] if _stem(first)[1] in SECONDS else f"{first} + {second}"
            time = stem or "time"
            time = f"{first} + {second}" if time in table.names else time
            times = np.asarray(unwrap_stamps(whole)[0] + second_in * part)
            signals = tuple(
                LongSignal(n, x, time, times, table.units.get(n, ""), "s")
                for n, x in table.columns.items()
                if n not in (first, second)
            )
            note = f"a time in two columns: {first!r} in s, and {second!r} in {unit}"
            return LongTable(signals, len(whole), note)
    return None


def are_parts_of_time(whole: Array, part: Array, *, per_second: float) -> bool:
    """Whether two columns (n,) are the seconds of a time and the parts of these seconds."""
    filled = np.isfinite(whole) & np.isfinite(part)
    whole, part = unwrap_stamps(whole[filled])[0], part[filled]
    if len(whole) < 2 or not np.array_equal(whole, np.round(whole)):
        return False
    if part.min() < 0 or part.max() >= per_second or part.max() < HALF * per_second:
        return False
    turns = np.diff(whole)
    return bool(turns.any() and np.all((turns >= 0) & ((turns > 0) | (np.diff(part) >= 0))))


def _parts_of_times(names: Sequence[str]) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Columns of one stem whose last words are a second and a part of it: "stamp.sec".

    A column called "ms" alone may hold the part of a time of day beside it, without fractions. So
    may the first two columns where no column has a name.
    """
    if names[0] == "column 1" and len(names) > 2:
        yield names[0], names[1], ("ns", "us")
    alone = [name for name in names if _stem(name)[0] == "" and _stem(name)[1] in PARTS]
    if len(alone) == 1:
        for first in (name for name in names if likeness(name, "time") > 0.0):
            yield first, alone[0], (PARTS[_stem(alone[0])[1]],)
    seconds = [name for name in names if _stem(name)[1] in SECONDS]
    parts = [name for name in names if _stem(name)[1] in PARTS]
    for first, second in itertools.product(seconds, parts):
        if _stem(first)[0] == _stem(second)[0]:
            yield first, second, (PARTS[_stem(second)[1]],)


def _stem(name: str) -> tuple[str, str]:
    """A name without its last word, and this word in lower case: ("header.stamp", "nanosec")."""
    end = max(name.rfind(sign) for sign in "._ /")
    return name[: max(end, 0)].rstrip("._ /"), name[end + 1 :].strip("()[]").lower()

"""An open log: the names of its columns, and a function that reads some of them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from ...base.errors import ExperimentError, quote

#: of an array: the index of a column, the name of a field, "" for the whole, None for a vector
ArrayPart = int | str | None
_NUMBER = re.compile(r" #\d+$")

#: rows above which a file is refused before it is read: fourteen hours at 1 kHz, 0.4 GB a column
MOST_ROWS = 50_000_000
#: most bytes of a packed file after unpacking: enough for MOST_ROWS rows of a few columns
MOST_BYTES = 4_000_000_000
#: most numbers of one message or list that become columns: images and point clouds are no log
MOST_FIELDS = 200
#: most columns of a matrix, or signals that the rows of a table name: more are no signals
MOST_SIGNALS = 1000
#: most structs of one array, and most machines whose rows stand in one table
MOST_PARTS = 64
#: levels of records within records that are looked into
DEPTH = 6
#: most columns of a log, and most characters of a name: far above those of any logger. The time for
#: a name may grow with the square of its length
MOST_COLUMNS, LONGEST_NAME = 10_000, 1000


@dataclass(frozen=True)
class Log:
    """An open log.

    names: of its columns, in order
    read: function from column -> channel that needs it, to column -> values as in the file
    units: column -> unit, where the file states one
    notes: remarks on the file ("semicolons, decimal comma")
    clocks: column -> column with its time stamps, where a log has several clocks (topics of a bag)
    remarks: lines of text above the table, names and units among them
    left_out: function, called after `read`: rows that were left out ("3 lines that are no rows")
    sample: column -> its first cells, where the file is a table of rows that may have any shape
    """

    names: tuple[str, ...]
    read: Callable[[Mapping[str, str]], Mapping[str, Any]]
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    clocks: Mapping[str, str] = field(default_factory=dict)
    left_out: Callable[[], tuple[str, ...]] = tuple
    remarks: tuple[str, ...] = ()
    sample: Mapping[str, Any] | None = None


def optional(module: str, file: str, extra: str = "io") -> ModuleType:
    """Import an optional package; raises ExperimentError: missing, with what to install."""
    try:
        return import_module(module)
    except ImportError:
        raise ExperimentError(
            f'{file}: reading it needs {module.split(".")[0]}: pip install "teleopdesign[{extra}]"'
        ) from None


@contextmanager
def refuse_damage(kind: str, file: str) -> Iterator[None]:
    """Turn any error of another package on a damaged file into one line.

    kind: what the file should be ("MAT file")
    raises ExperimentError: in place of all errors except those of the system and of memory
    """
    try:
        yield
    except (ExperimentError, OSError, EOFError, MemoryError):
        raise
    except Exception as problem:  # those packages name no class for it
        reason = str(problem).strip().split("\n")[0] or type(problem).__name__
        raise ExperimentError(f"{file}: not a readable {kind}: {reason}") from None


def refuse_size(rows: int, file: str) -> None:
    """Raise an ExperimentError for a file that states more rows than `MOST_ROWS`."""
    if rows > MOST_ROWS:
        raise ExperimentError(
            f"{file}: found {rows:.4g} rows, expected at most {MOST_ROWS:.4g}: cut the record"
        )


def refuse_odd_names(log: Log, file: str) -> None:
    """Raise an ExperimentError for too many columns, or for a column name that is too long."""
    if len(log.names) > MOST_COLUMNS:
        raise ExperimentError(
            f"{file}: found {len(log.names)} columns, expected at most {MOST_COLUMNS}"
        )
    longest = max(log.names, key=len, default="")
    if len(longest) > LONGEST_NAME:
        raise ExperimentError(
            f"{file}: found a column whose name has {len(longest)} characters, expected at most "
            f"{LONGEST_NAME}: {quote(longest)}"
        )


def number_names(names: Sequence[str]) -> tuple[str, ...]:
    """Unique names of columns: names that occur several times get "#1", "#2" ..."""
    of_all, count = Counter(names), Counter[str]()
    out = []
    for name in names:
        count[name] += 1
        out.append(f"{name} #{count[name]}" if of_all[name] > 1 else name)
    return tuple(out)


def bare_column(name: str) -> str:
    """The name of a column in the file, without the number that `number_names` added."""
    return _NUMBER.sub("", name)


def parts_of(name: str, shape: Sequence[int]) -> dict[str, tuple[str, ArrayPart]]:
    """Columns of an array: "x" of a vector, "x(:,1)" ... of a matrix.

    What is no column is listed too, so that a message can say what is wrong with it.
    returns: column -> (name of the array, index of the column from 0, "" for the whole array)
    """
    parts: dict[str, tuple[str, ArrayPart]] = {}
    if len(shape) == 2 and 2 <= shape[1] <= MOST_SIGNALS and shape[0] > shape[1]:
        parts = {f"{name}(:,{k + 1})": (name, k) for k in range(shape[1])}
    return parts | {name: (name, "" if len(shape) == 2 and 1 not in shape else None)}


def log_of_arrays(
    columns: Mapping[str, tuple[str, ArrayPart]],
    load: Callable[[Sequence[str]], Mapping[str, Any]],
    file: str,
    *,
    units: Mapping[str, str] | None = None,
    objects: Sequence[str] = (),
) -> Log:
    """The log of a file of arrays, whose columns are parts of them (`parts_of`).

    load: function from names of arrays to arrays
    objects: variables that only MATLAB can unpack; a note says how to save them readably
    raises ExperimentError: there is nothing else
    """
    notes = tuple(
        f"{quote(name)} is a timetable, table or other object that only MATLAB can unpack: in "
        'MATLAB, writetimetable(T, "log.csv") or S = table2struct(timetable2table(T), "ToScalar", '
        'true); save("log.mat", "S")'
        for name in objects
    )
    if notes and not columns:
        raise ExperimentError(f"{file}: {notes[0]}")

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        arrays = load([*dict.fromkeys(columns[name][0] for name in wanted)])
        return {name: _part(arrays[columns[name][0]], columns[name][1]) for name in wanted}

    return Log(tuple(columns), read, units or {}, tuple(f"{n}; it is left out" for n in notes))


def _part(values: Any, part: ArrayPart) -> Any:
    """A part of an array: a column by its index, a field by its name, or all of a vector."""
    if isinstance(part, str):
        return values[part] if part else values
    array = np.asarray(values)
    return array.reshape(-1) if part is None else array[:, part]


def join_names(names: Iterable[str], most: int = 20) -> str:
    """Names for a message; an empty one is written as such."""
    names = [name or '""' for name in names]
    return ", ".join(names[:most]) + (", ..." if len(names) > most else "")

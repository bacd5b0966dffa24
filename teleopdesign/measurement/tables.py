"""Columns of a log: which reader opens the file, and its content as numbers, without conversion."""

from __future__ import annotations

import shlex
import zlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

from ..base.errors import ExperimentError, did_you_mean, quote
from .doors._cells import numbers_of
from .doors._dialect import LOOKED_AT
from .doors._log import Log, bare_column, join_names, refuse_odd_names
from .doors.json_records import open_json
from .doors.matlab import open_matlab
from .doors.shapes import with_best_shape
from .doors.text import open_text, open_workbook
from .doors.topics import is_bag, open_bag, open_folder
from .doors.typed_arrays import open_arrays, open_hdf5, open_parquet
from .encoder import Array
from .reading import ReadingStep
from .stamps import unwrap_stamps

Result = TypeVar("Result")
Wanted = Mapping[str, str]
"""Column -> the channel that wants it (for messages, "channels.position")."""

DOORS: Mapping[str, Callable[[Path, str], Log]] = {
    **dict.fromkeys((".csv", ".csv.gz", ".txt", ".tsv", ".dat", ".log", ".lvm"), open_text),
    **dict.fromkeys((".asc", ".sto", ".mot", ".trc"), open_text),
    **dict.fromkeys((".json", ".jsonl", ".ndjson"), open_json),
    ".parquet": open_parquet,
    ".xlsx": open_workbook,
    ".mat": open_matlab,
    ".npz": open_arrays,
    **dict.fromkeys((".h5", ".hdf5"), open_hdf5),
    **dict.fromkeys((".bag", ".mcap", ".db3"), open_bag),
}
#: first bytes of a file -> the function that reads such a file
BEGINNINGS: Mapping[bytes, Callable[[Path, str], Log]] = {
    b"\x89HDF\r\n\x1a\n": open_hdf5,
    b"PAR1": open_parquet,
    b"MATLAB ": open_matlab,
    b"{": open_json,
    b"[": open_json,
}
#: name of the file that makes a folder an experiment
EXPERIMENT = "experiment.toml"


@dataclass(frozen=True)
class LogColumns:
    """Columns of one log as numbers, NaN where a cell holds none.

    values: column -> (n,);  stamps: column with a separate clock -> its stamps (n,), s
    notes: remarks on the file;  begin: s from the first row of the log to that of these columns
    """

    values: Mapping[str, Array]
    stamps: Mapping[str, Array] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    begin: float = 0.0

    def steps(self, file: str) -> tuple[ReadingStep, ...]:
        """Remarks on the file, as steps of reading."""
        return tuple(ReadingStep(file, note, "read accordingly", "none") for note in self.notes)


def open_log(path: Path, file: str) -> Log:
    """Open a log with the reader for its kind of file.

    file: its name in messages ("rod/fit.csv.gz")
    raises ExperimentError: unknown kind of file, or a file that cannot be read
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise ExperimentError(f"{file}: found a pipe or a device, expected a file")
    opened: Callable[[Path, str], Log] | None = open_bag if is_bag(path) else None
    if opened is None and path.is_dir() and (parts := tables_in(path)):
        return _read_with_errors(lambda: open_folder(path, file, parts, open_log), file)
    if opened is None:
        name = path.name.lower()
        opened = next((door for ending, door in DOORS.items() if name.endswith(ending)), None)
    if opened is None and path.is_file():
        opened = _read_with_errors(lambda: _door_by_content(path, file), file)
    if opened is None and (path / EXPERIMENT).exists():
        word = shlex.quote(str(path))
        raise ExperimentError(
            f"{file}: is an experiment already; next: teleopdesign diagnose {word}"
        )
    if opened is None:
        kind = "a folder" if path.is_dir() else f"a file of kind {quote(path.suffix)}"
        more = ", or a folder of tables" if path.is_dir() else ""
        raise ExperimentError(f"{file}: found {kind}, expected {', '.join(DOORS)}{more}")
    door = opened
    whole = _read_with_errors(lambda: door(path, file), file)
    refuse_odd_names(whole, file)
    log = _read_with_errors(lambda: with_best_shape(whole), file)
    return replace(log, read=lambda wanted: _read_with_errors(lambda: log.read(wanted), file))


def _door_by_content(path: Path, file: str) -> Callable[[Path, str], Log] | None:
    """The reader for a file whose ending does not decide ("run12", "log.data"); None: no log."""
    with path.open("rb") as stream:
        head = stream.read(LOOKED_AT)
    for begin, door in BEGINNINGS.items():
        if head.startswith(begin):
            return door
    if head[:2] in (b"PK", b"\x1f\x8b") or b"\0" in head or b"\n" not in head:
        return None
    try:
        open_text(path, file)
    except ExperimentError:  # a text without a table: the message names the ending of the file
        return None
    return open_text


def tables_in(folder: Path) -> list[Path]:
    """The files of a folder that are tables, sorted by name; empty for an experiment."""
    if (folder / EXPERIMENT).exists():
        return []
    inside = folder.resolve()  # links out of the folder are not followed
    files = [p for p in folder.iterdir() if p.is_file() and p.resolve().parent == inside]
    return sorted(p for p in files if is_log(p) and not is_bag(p))


def is_log(path: Path) -> bool:
    """Whether the name of a file has the ending of a log that can be read."""
    return path.name.lower().endswith(tuple(DOORS))


def _read_with_errors(read: Callable[[], Result], file: str) -> Result:
    try:
        return read()
    except (OSError, EOFError, zlib.error, MemoryError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem) or type(problem).__name__
        raise ExperimentError(f"{file}: cannot be read: {reason}") from None


def read_columns(path: Path, file: str, wanted: Wanted) -> LogColumns:
    """The wanted columns of one file, each of shape (n,), as written.

    file: the file's name in messages ("rod/fit.csv.gz")
    raises ExperimentError: unknown kind of file, unreadable, column missing, not numbers, columns
        of different length
    """
    try:
        known = path.stat()
        state = (known.st_mtime_ns, known.st_size) if path.is_file() else None
    except OSError:
        state = None
    if state is None:  # a folder of tables, or what is not there
        return columns_of(open_log(path, file), file, wanted)
    return _columns_of_file(path.resolve(), file, state, tuple(wanted.items()))


# the fit and the check record are often parts of one file
@lru_cache(maxsize=2)
def _columns_of_file(
    path: Path, file: str, state: object, wanted: tuple[tuple[str, str], ...]
) -> LogColumns:
    """The columns of a file, read once as long as it stays as it is: nothing writes into them."""
    columns = columns_of(open_log(path, file), file, dict(wanted))
    for values in columns.values.values():
        values.setflags(write=False)
    return columns


def columns_of(log: Log, file: str, wanted: Wanted) -> LogColumns:
    """The wanted columns of an open log; raises the errors of `read_columns`."""
    require_columns(log.names, file, wanted)
    names = list(wanted)
    base = next((c for c, channel in wanted.items() if channel == "channels.time"), None)
    clocks = {n: log.clocks[n] for n in names if n in log.clocks and log.clocks[n] != base}
    if base is not None and base in log.clocks and log.clocks[base] != base:
        clocks = {n: clock for n, clock in clocks.items() if clock != log.clocks[base]}
    channel_of = {**wanted, **dict.fromkeys(clocks.values(), "channels.time")}
    read = log.read(channel_of)
    try:
        values = {n: numbers_of(read[n], n, file, wanted.get(n, "")) for n in read}
    except MemoryError:
        raise ExperimentError(f"{file}: too large for this machine's memory") from None
    stamps = {n: values[clock] for n, clock in clocks.items()}
    notes = log.notes + log.left_out()
    for name in (n for n in names if wanted[n] == "channels.time"):
        values[name], more = unwrap_stamps(values[name])
        notes += more
    columns = LogColumns({n: values[n] for n in names}, stamps, notes)
    _refuse_different_lengths(columns, file, wanted)
    return columns


def require_columns(columns: Iterable[str], file: str, wanted: Wanted) -> None:
    """Raise an ExperimentError for the first wanted column that is not in the log."""
    columns = list(columns)
    for column, channel in wanted.items():
        same = [name for name in columns if bare_column(name) == column]
        if column not in columns and same:
            raise ExperimentError(
                f"{file}: {channel}: found {len(same)} columns {quote(column)}, "
                f"expected one of {', '.join(map(quote, same))}"
            )
        if column not in columns:
            raise ExperimentError(
                f"{file}: {channel}: no column {quote(column)}, "
                f"found {join_names(columns) or 'no column'}{did_you_mean(column, columns)}"
            )


def _refuse_different_lengths(columns: LogColumns, file: str, wanted: Wanted) -> None:
    names = [n for n in columns.values if n not in columns.stamps]
    if not names:
        return
    first, *others = names
    for other in others:
        if len(columns.values[other]) != len(columns.values[first]):
            raise ExperimentError(
                f"{file}: {wanted[other]}: column {quote(other)} has "
                f"{len(columns.values[other])} rows, "
                f"expected {len(columns.values[first])} as {quote(first)}"
            )

"""Lines of a text file, with the stamps of a serial monitor as cells.

10:11:12.789 -> angle,current            received,angle,current
10:11:12.799 -> 0.12,1.3        becomes  36672.799,0.12,1.3
[2025-01-06 10:11:12.809] 0.13,1.2       1736158272.809,0.13,1.2
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path

from ._cells import seconds_of
from ._dialect import LOOKED_AT, Dialect, cells_of, open_bytes, separator_of
from ._units_in_cells import units_in_cells
from ._vectors_in_cells import vectors_in_cells

#: what a serial monitor writes before each line: a time, and "->" behind it or brackets around it
_STAMP = re.compile(
    r"\s*+(?P<bracket>\[)?(?P<date>\d{4}-\d\d-\d\d[ T])?"
    r"(?P<h>\d\d?):(?P<min>\d\d):(?P<s>\d\d(?:[.,]\d++)?)(?(bracket)\]|\s*+->)[ \t]*+"
)
#: part of the lines that have such a stamp; the first ones after a start may be messages
MOST_OF_THEM = 0.8
#: name of the column of stamps. No word of time, so that a time of the microcontroller comes first
RECEIVED = "received"


def are_stamped(lines: Sequence[str]) -> bool:
    """Whether a serial monitor has written a time before each line."""
    filled = [line for line in lines if line.strip()]
    count = sum(_STAMP.match(line) is not None for line in filled)
    return count >= 3 and count >= MOST_OF_THEM * len(filled)


def edit_of(
    lines: Sequence[str],
) -> tuple[Callable[[Iterable[str]], Iterable[str]], list[str]]:
    """How the lines of a file become those of a table, judged from the first ones; and remarks."""
    if are_stamped(lines):
        sent = [_STAMP.sub("", line, count=1) for line in lines]
        separator, comma = separator_of([line for line in sent if line.strip()])
        edit = partial(with_stamps_as_cells, separator=separator, comma=comma)
        return edit, ["times of a serial monitor before each line"]
    if (units := units_in_cells(lines)) is not None:
        return units, ["units behind the numbers"]
    if (vectors := vectors_in_cells(lines)) is not None:
        return vectors, ["vectors in cells: a column for each element"]
    return iter, []


def with_stamps_as_cells(
    lines: Iterable[str], separator: str, *, comma: bool = False
) -> Iterator[str]:
    """The lines with each stamp in s as their first cell; "received" before a row of names.

    separator: between the cells; "=" for pairs of names and values
    """
    for line in lines:
        match = _STAMP.match(line)
        if match is None:
            yield line
            continue
        rest = line[match.end() :]
        if not rest.strip():
            continue
        minutes = 60 * int(match["h"]) + int(match["min"])
        seconds = 60 * minutes + float(match["s"].replace(",", "."))
        stamp = f"{_day(match['date'] or '') + seconds:.6f}"
        if separator == "=":
            yield f"{RECEIVED}={stamp} {rest}"
        elif rest[:1].isalpha():
            yield f"{RECEIVED}{separator}{rest}"
        else:
            yield f"{stamp.replace('.', ',') if comma else stamp}{separator}{rest}"


@cache
def _day(date: str) -> float:
    """The time of midnight of a date, s; 0 without a date."""
    return (seconds_of(f"{date.strip('T ')} 00:00:00") or 0.0) if date else 0.0


@contextmanager
def open_lines(
    path: Path,
    encoding: str,
    edit: Callable[[Iterable[str]], Iterable[str]] = iter,
    *,
    errors: str = "strict",
) -> Iterator[Iterable[str]]:
    """The lines of a file, edited."""
    with open_bytes(path) as raw, io.TextIOWrapper(raw, encoding, errors=errors) as stream:
        yield edit(stream)


def last_lines(path: Path, dialect: Dialect) -> list[str]:
    """The last lines with text, the first of them perhaps only in part; none of a packed file."""
    if path.name.lower().endswith(".gz"):
        return []
    with path.open("rb") as stream:
        stream.seek(0, 2)
        stream.seek(max(0, stream.tell() - LOOKED_AT))
        tail = stream.read().decode(dialect.encoding.removesuffix("-sig"), errors="ignore")
    lines = tail.replace("\r", "\n").split("\n")
    return [*dialect.edit(line for line in lines if line.strip())]


def is_cut_off(path: Path, dialect: Dialect) -> bool:
    """Whether the last row has too few cells; False for packed files and for space as separator."""
    lines = [] if dialect.separator == " " else last_lines(path, dialect)
    cells = cells_of(lines[-1], dialect.separator) if len(lines) > 1 else []
    return 0 < len(cells) < len(dialect.header)

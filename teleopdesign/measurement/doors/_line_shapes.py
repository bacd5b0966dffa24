"""Shapes of lines: how the lines of a text become rows of cells with one name for each column.

A shape is a function from the first lines of a file to the edit of its lines, and None for a file
of another shape. Each edit leads to plain rows, which then are judged as those of any other table.
A new shape is a function in `LINE_SHAPES`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache

from ...base.errors import ExperimentError, quote
from ..limits import FEWEST, HALF, NEARLY_ALL, SEVERAL
from ._cell_shapes import LineShape, units_behind_numbers, vectors_in_cells
from ._cells import is_empty, is_number, seconds_of
from ._dialect import COMMENTS, cells_of, separator_of
from ._header import bare_unit, is_unit_cell

#: readings of a switch in a trace
SWITCH = {"TRUE": "1", "FALSE": "0"}
#: name of the column of a monitor's stamps. No word of time, so that a time of the microcontroller
#: comes first
RECEIVED = "received"
#: what a serial monitor writes before each line: a time, and "->" behind it or brackets around it
_STAMP = re.compile(
    r"\s*+(?P<bracket>\[)?(?P<date>\d{4}-\d\d-\d\d[ T])?"
    r"(?P<h>\d\d?):(?P<min>\d\d):(?P<s>\d\d(?:[.,]\d++)?)(?(bracket)\]|\s*+->)[ \t]*+"
)
#: a name, "=" or ":", a number, a unit, and what stands between pairs. Possessive, and matched from
#: where the last pair ended: a long line is decided at once
_PAIR = re.compile(
    r"[\s,;|]*+([^\W\d][\w./]*+(?:\[\d++\])?)\s*+[=:]\s*+"
    r"([-+]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][-+]?\d++)?|nan)([^\W\d]*+)(?:[\s,;|]++|$)"
)
#: a name with a vector behind it
_NAMED_VECTOR = re.compile(r"([^\W\d][\w./]*+)\s*+[=:]\s*+(?:array\()?[\[(]([^\[\]()=:]*+)[\])]\)?")
#: lines of a trace that name a signal, and after which its rows begin
_NAME = re.compile(r"\d++\.Variable\s*+;(.*)$")
_DATA = re.compile(r"\d++\.Data\s*+;\s*+$")
_BYTES = r"(?:[ \t]++[0-9A-Fa-f]{2}\b)"
_FRAME = re.compile(
    r"\b[0-9A-Fa-f]{3,8}##?[0-9A-Fa-f]*+\b"  # candump -L
    rf"|\b[0-9A-Fa-f]{{3,8}}[ \t]++\[\d\d?\]{_BYTES}*"  # candump
    rf"|\b[RT]x[ \t].*[ \t]\d\d?{_BYTES}{{2}}"  # analysers: direction, length, bytes
)


def rows_of_cells(lines: Sequence[str], file: str) -> LineShape | None:
    """Each line is a row."""
    return LineShape()


def frames_of_a_bus(lines: Sequence[str], file: str) -> LineShape | None:
    """Refuse the frames of a CAN bus: which of their bytes are a position is not in the file.

    (1736150000.123656) can0 181#3712A0FEFFFF2C00
    can0  181   [8]  37 12 A0 FE FF FF 2C 00
    """
    filled = [line[:200] for line in lines if line.strip()]
    if _share(filled, _FRAME.search) < HALF:
        return None
    raise ExperimentError(
        f"{file}: found frames of a CAN bus, expected signals: decode them into a table with "
        "the time of each frame (cantools does it with the description of the bus), in columns "
        "such as time, position and torque"
    )


def stamps_of_a_monitor(lines: Sequence[str], file: str) -> LineShape | None:
    """A time before each line, as a serial monitor writes it: it becomes the first cell, in s.

    10:11:12.789 -> angle,current            received,angle,current
    10:11:12.799 -> 0.12,1.3        becomes  36672.799,0.12,1.3
    """
    if _share(lines, _STAMP.match) < NEARLY_ALL:
        return None
    sent = [_STAMP.sub("", line, count=1) for line in lines]
    separator, comma = separator_of([line for line in sent if line.strip()])
    if names_and_values(sent, file) is not None:
        separator, comma = "=", False

    def edit(lines: Iterable[str]) -> Iterator[str]:
        for line in lines:
            match = _STAMP.match(line)
            rest = line if match is None else line[match.end() :]
            if match is None:
                yield line
            elif separator == "=":
                yield f"{RECEIVED}={_stamp(match)} {rest}"
            elif rest[:1].isalpha():
                yield f"{RECEIVED}{separator}{rest}"
            elif rest.strip():
                yield f"{_stamp(match).replace('.', ',' if comma else '.')}{separator}{rest}"

    pairs = names_and_values([*edit(lines)], file) if separator == "=" else None
    note = "times of a serial monitor before each line"
    if pairs is not None:
        return LineShape(lambda lines: pairs.edit(edit(lines)), note, pairs.units)
    return LineShape(edit, note)


def _stamp(match: re.Match[str]) -> str:
    seconds = 60 * (60 * int(match["h"]) + int(match["min"]))
    whole = _day(match["date"] or "") + seconds + float(match["s"].replace(",", "."))
    return f"{whole:.6f}"


@cache
def _day(date: str) -> float:
    """The time of midnight of a date, s; 0 without a date."""
    return (seconds_of(f"{date.strip('T ')} 00:00:00") or 0.0) if date else 0.0


def names_and_values(lines: Sequence[str], file: str) -> LineShape | None:
    """Names and values in each line, as a microcontroller prints it: "t=0.001 pos=0.28 cmd=-1"."""
    filled = [line for line in lines if line.strip()]
    rows = [row for line in filled if (row := pairs_of(line))]
    if len(rows) < SEVERAL or len(rows) < NEARLY_ALL * len(filled):
        return None
    # names from the second line: the first line of a dump may be incomplete
    names = [name for name, _, _ in rows[1]]
    if len(set(names)) < len(names):
        return None

    def edit(lines: Iterable[str]) -> Iterator[str]:
        header = ",".join(names) + "\n"
        for line in lines:
            row = pairs_of(line)
            if [name for name, _, _ in row] == names:
                yield from filter(None, (header, ",".join(number for _, number, _ in row) + "\n"))
                header = ""
            elif line.strip() and not header:
                yield "-\n"  # a line of another form is no row

    units = [(name, bare_unit(u)) for name, _, u in rows[1] if u and is_unit_cell(u)]
    return LineShape(edit, "names and values in each line", tuple(units))


def pairs_of(line: str) -> list[tuple[str, str, str]]:
    """(name, number, unit) of each pair in a line; empty if the line is anything but pairs."""
    pairs, end = [], 0
    if any(sign in line for sign in "[("):
        line = _with_elements(line)
    while end < len(line) and (match := _PAIR.match(line, end)) is not None:
        pairs.append((match[1], match[2], match[3]))
        end = match.end()
    return pairs if len(pairs) > 1 and end == len(line) else []


def _with_elements(line: str) -> str:
    """A line of pairs with a pair for each element of its vectors."""

    def elements(match: re.Match[str]) -> str:
        numbers = [number for number in re.split(r"[\s,;]+", match[2]) if number]
        return " ".join(f"{match[1]}[{k}]={number}" for k, number in enumerate(numbers))

    return _NAMED_VECTOR.sub(elements, line)


def trace_of_a_controller(lines: Sequence[str], file: str) -> LineShape | None:
    """A trace after IEC 61131, a signal after the other: rows become a reading with its signal.

    0.Variable; Axis.ActPosition               signal;time;value
    0.Data;                           becomes
    ; 2; 0.10                                  Axis.ActPosition;2;0.10
    """
    first = next((k for k, line in enumerate(lines) if _NAME.match(line.rstrip())), None)
    if first is None or not any(_DATA.match(line.rstrip()) for line in lines[first:]):
        return None

    def edit(lines: Iterable[str]) -> Iterator[str]:
        yield "signal;time;value\n"
        name, here, count = "", False, 0
        for number, line in enumerate(lines, 1):
            if (match := _NAME.match(line.rstrip())) is not None:
                name, here = match[1].strip(), False
            elif _DATA.match(line.rstrip()):
                here = True
            elif here and line.strip():
                cells = [cell.strip() for cell in line.split(";") if cell.strip()]
                if len(cells) != 2 or not is_number(cells[0], any("," in c for c in cells)):
                    raise ExperimentError(
                        f"{file}: line {number}: found {quote(line.strip())}, expected a time and "
                        "a reading"
                    )
                yield f"{name};{cells[0]};{SWITCH.get(cells[1].upper(), cells[1])}\n"
                count += 1
        if not count:
            raise ExperimentError(f"{file}: found signals without rows, expected at least 64 rows")

    return LineShape(edit, "a trace with a signal after the other")


def signal_in_each_row(lines: Sequence[str], file: str) -> LineShape | None:
    """A signal in each row, as a matrix of row vectors is written: the table is turned.

    A recording has 64 rows or more, so that a table of fewer rows with as many cells is turned.
    """
    filled = [s for line in lines if (s := line.strip()) and not s.startswith(COMMENTS)]
    if not 2 <= len(filled) < FEWEST:
        return None
    separator, comma = separator_of(filled)
    rows = [cells_of(line.rstrip(separator), separator) for line in filled]
    if len({*map(len, rows)}) > 1 or len(rows[0]) < FEWEST:
        return None
    named = not any(is_number(row[0], comma) for row in rows)
    if not all(is_number(cell, comma) or is_empty(cell) for row in rows for cell in row[named:]):
        return None

    def edit(lines: Iterable[str]) -> Iterator[str]:
        filled = [s for line in lines if (s := line.strip()) and not s.startswith(COMMENTS)]
        rows = [cells_of(line.rstrip(separator), separator) for line in filled]
        if not named:
            rows = [[f"column {k}", *row] for k, row in enumerate(rows, 1)]
        for row in zip(*rows, strict=False):
            yield separator.join(f'"{c}"' if separator in c else c for c in row) + "\n"

    return LineShape(edit, "a signal in each row: read as columns")


#: all shapes. Of equally good readings the first one counts
LINE_SHAPES: tuple[Callable[[Sequence[str], str], LineShape | None], ...] = (
    frames_of_a_bus,
    rows_of_cells,
    stamps_of_a_monitor,
    units_behind_numbers,
    vectors_in_cells,
    names_and_values,
    trace_of_a_controller,
    signal_in_each_row,
)


def _share(lines: Sequence[str], has_shape: Callable[[str], object]) -> float:
    """Part of the lines with a text that have a shape; 0 for less than three."""
    filled = [line for line in lines if line.strip()]
    count = sum(bool(has_shape(line)) for line in filled)
    return count / len(filled) if count >= SEVERAL else 0.0

"""Text of names and values, as a microcontroller prints it: "t=0.001 pos=0.28 cmd=-1.2"."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ...base.errors import ExperimentError
from ._cells import number_of
from ._header import bare_unit, is_unit_cell
from ._log import Array, Log, refuse_size

#: a name, "=" or ":", a number, a unit, and what stands between pairs. Possessive, and matched from
#: where the last pair ended: a long line is decided at once
_PAIR = re.compile(
    r"[\s,;|]*+([^\W\d][\w./]*+(?:\[\d++\])?)\s*+[=:]\s*+"
    r"([-+]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][-+]?\d++)?|nan)([^\W\d]*+)(?:[\s,;|]++|$)"
)
#: a name in quotes, as Python prints those of a dict; and a name with a vector behind it
_QUOTED = re.compile(r"(['\"])([^\W\d][\w./ ]*+)\1(?=\s*+:)")
_VECTOR = re.compile(r"([^\W\d][\w./]*+)\s*+[=:]\s*+(?:array\()?[\[(]([^\[\]()=:]*+)[\])]\)?")
#: part of the lines that must be pairs with the same names; other lines are messages and left out
MOST_OF_THEM = 0.8


def pairs_of(line: str) -> list[tuple[str, str, str]]:
    """(name, number, unit) of each pair in a line; empty if the line is anything but pairs."""
    pairs, end = [], 0
    if any(sign in line for sign in "[({"):
        line = _with_elements(line)
    while end < len(line) and (match := _PAIR.match(line, end)) is not None:
        pairs.append((match[1], match[2], match[3]))
        end = match.end()
    return pairs if len(pairs) > 1 and end == len(line) else []


def _with_elements(line: str) -> str:
    """A line of pairs with a pair for each element of its vectors, without braces and quotes."""
    line = _QUOTED.sub(lambda m: m[2].replace(" ", "_"), line.strip())
    if line.startswith("{") and line.endswith("}"):
        line = line[1:-1]
    return _VECTOR.sub(lambda m: " ".join(_element_pairs(m[1], m[2])), line)


def _element_pairs(name: str, vector: str) -> list[str]:
    numbers = [number for number in re.split(r"[\s,;]+", vector) if number]
    return [f"{name}[{k}]={number}" for k, number in enumerate(numbers)]


def names_in_lines(lines: Sequence[str]) -> dict[str, str]:
    """Name -> unit for a file written in pairs; empty: the file is a table."""
    filled = [line for line in lines if line.strip()]
    rows = [row for line in filled if (row := pairs_of(line))]
    if len(rows) < 3 or len(rows) < MOST_OF_THEM * len(filled):
        return {}
    # names from the second line: the first line of a dump may be incomplete
    units = {name: bare_unit(unit) if is_unit_cell(unit) else "" for name, _, unit in rows[1]}
    return units if len(units) == len(rows[1]) else {}


def log_of_pairs(
    path: Path, file: str, encoding: str, units: Mapping[str, str], *, stamped: bool = False
) -> Log:
    """The log of a file whose lines are pairs.

    units: of each name, from `names_in_lines`;  stamped: with times of a serial monitor
    """
    from ._lines_of_file import open_lines, with_stamps_as_cells

    edit = partial(with_stamps_as_cells, separator="=") if stamped else iter
    strays: list[int] = []

    def read(wanted: Mapping[str, str]) -> Mapping[str, Array]:
        strays.clear()
        names, rows = tuple(units), []
        with open_lines(path, encoding, edit, errors="replace") as stream:
            for line in stream:
                row = pairs_of(line)
                if tuple(name for name, _, _ in row) == names:
                    rows.append([float(number_of(number)) for _, number, _ in row])
                elif line.strip():
                    strays.append(len(rows) + 1)
                refuse_size(len(rows), file)
        if len(strays) > max(10, (1 - MOST_OF_THEM) * len(rows)):
            raise ExperimentError(
                f"{file}: row {strays[0]}: found other names than {', '.join(names)}, "
                "expected the same ones in every line"
            )
        table = np.array(rows, dtype=np.float64).reshape(len(rows), len(names))
        return {name: table[:, names.index(name)].copy() for name in wanted}

    def left_out() -> tuple[str, ...]:
        return (f"{len(strays)} lines of another form: left out",) if strays else ()

    notes = ("names and values in each line",)
    return Log(tuple(units), read, {n: u for n, u in units.items() if u}, notes, left_out=left_out)

"""Shapes of cells: units behind numbers, and vectors, which become plain cells of their own."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from ._cells import is_number
from ._dialect import SEPARATORS, cells_of
from ._header import bare_unit, is_unit_cell

Edit = Callable[[Iterable[str]], Iterable[str]]
#: rows that tell how cells are written
ROWS = 20
#: a number and a unit behind it
_WITH_UNIT = re.compile(
    r"([-+]?(?:\d++(?:[.,]\d*+)?|[.,]\d++)(?:[eE][-+]?\d++)?) ?+([^\W\d_].*|[°%].*)$"
)
#: a cell that holds a vector: "[1, 2]", "(1, 2)", "array('d', [1, 2])", of numpy "[1. 2.]"
_VECTOR = re.compile(r"(?:array\()?(?:'\w',\s*+)?[\[(]([^\[\]()]*+)[\])]\)?$")


@dataclass(frozen=True)
class LineShape:
    """How the lines of a file become plain rows.

    edit: function from the lines of the file to those of the table;  note: on the shape
    units: column -> unit, where the edit takes units out of the lines
    """

    edit: Edit = iter
    note: str = ""
    units: tuple[tuple[str, str], ...] = ()


def units_behind_numbers(lines: Sequence[str], file: str) -> LineShape | None:
    """A unit behind each number of a column, as MATLAB writes durations: "0.01 sec,12.2 deg"."""
    separator, header, rows = _even_rows(lines)
    if not rows or any(map(_WITH_UNIT.match, header)):
        return None
    written = [_unit_of(column) for column in zip(*rows, strict=True)]
    if not any(written):
        return None

    def edit(lines: Iterable[str]) -> Iterator[str]:
        for line in lines:
            cells = cells_of(line, separator)
            whole = len(cells) == len(header) and cells != header
            if not whole or '"' in line and separator in "".join(cells):
                yield line
                continue
            bare = (
                cell if unit is None else cell.removesuffix(unit).rstrip()
                for cell, unit in zip(cells, written, strict=True)
            )
            yield separator.join(bare) + "\n"

    units = [(n, bare_unit(u)) for n, u in zip(header, written, strict=True) if u is not None]
    return LineShape(edit, "units behind the numbers", tuple(units))


def _unit_of(column: Sequence[str]) -> str | None:
    """The unit behind all numbers of a column; None: they have none, or several."""
    matches = [_WITH_UNIT.match(cell) for cell in column]
    units = {None if match is None else match[2] for match in matches}
    unit = units.pop() if len(units) == 1 else None
    return unit if unit and is_unit_cell(bare_unit(unit)) else None


def vectors_in_cells(lines: Sequence[str], file: str) -> LineShape | None:
    """Vectors in cells, as tables of messages are exported: a column for each element.

    time, name, position                             time, hip.position, knee.position
    0.00, "['hip', 'knee']", "[0.10, 2.30]"  becomes  0.00, 0.10,         2.30
    """
    separator, header, rows = _even_rows(lines)
    columns = [[_elements(cell) for cell in column] for column in zip(*rows, strict=True)]
    lengths = [{None if v is None else len(v) for v in column} for column in columns]
    if not any(len(n) == 1 and n != {None} for n in lengths):
        return None
    vectors = [c[0] if len(n) == 1 else None for c, n in zip(columns, lengths, strict=True)]
    names = _names_of_elements(header, vectors)

    def joined(parts: Iterable[Sequence[str]]) -> str:
        pairs = (zip(*both, strict=True) for both in zip(names, parts, strict=True))
        kept = [cell for pair in pairs for name, cell in pair if name]
        return separator.join(f'"{c}"' if separator in c else c for c in kept) + "\n"

    def edit(lines: Iterable[str]) -> Iterator[str]:
        for line in lines:
            cells = cells_of(line, separator)
            if cells == header:
                yield joined(names)
                continue
            parts = [
                [cell] if vector is None else _elements(cell) or []
                for cell, vector in zip(cells, vectors, strict=False)
            ]
            whole = len(cells) == len(parts) and [*map(len, parts)] == [*map(len, names)]
            # without quotes a row of other vectors has another number of cells, and is no row
            yield joined(parts) if whole else line.replace('"', "")

    return LineShape(edit, "vectors in cells: a column for each element")


def _elements(cell: str) -> list[str] | None:
    """The elements of a vector; None: the cell holds none."""
    match = _VECTOR.match(cell.strip())
    if match is None:
        return None
    inside = match[1].strip()
    parts = inside.split(",") if "," in inside else inside.split()
    return [part.strip(" '\"") for part in parts if part.strip()]


def _names_of_elements(
    header: Sequence[str], vectors: Sequence[list[str] | None]
) -> list[list[str]]:
    """The names of all elements: of joints, where one column names as many, else by number.

    vectors: of the first row, None for a cell of another kind
    returns: "" for an element that is no number
    """
    texts = [v for v in vectors if v and not any(is_number(e, False) for e in v)]
    out = []
    for name, vector in zip(header, vectors, strict=True):
        joints = texts[0] if len(texts) == 1 and vector and len(vector) == len(texts[0]) else None
        if vector is None:
            out.append([name])
        elif vector in texts:
            out.append([""] * len(vector))
        else:
            numbered = [f"{name}[{k}]" for k in range(len(vector))]
            out.append([f"{joint}.{name}" for joint in joints] if joints else numbered)
    return out


def _even_rows(lines: Sequence[str]) -> tuple[str, list[str], list[list[str]]]:
    """Separator, cells of the first line and of the next ones, where all have as many cells."""
    filled = [line for line in lines if line.strip()][: ROWS + 1]
    for separator in (s for s in SEPARATORS if s != " "):
        rows = [cells_of(line, separator) for line in filled]
        (width, count), *_ = Counter(map(len, rows)).most_common(1) or [(0, 0)]
        if width > 1 and count == len(rows) > 2:
            return separator, rows[0], rows[1:]
    return ",", [], []

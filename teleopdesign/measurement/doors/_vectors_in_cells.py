"""Text tables with vectors in their cells, as tables of messages are exported.

time, name, position                             time, hip.position, knee.position
0.00, "['hip', 'knee']", "[0.10, 2.30]"  becomes  0.00, 0.10,         2.30
0.01, "['hip', 'knee']", "[0.11, 2.31]"           0.01, 0.11,         2.31
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ._cells import is_number
from ._dialect import SEPARATORS, cells_of

#: a cell that holds a vector: "[1, 2]", "(1, 2)", "array('d', [1, 2])", of numpy "[1. 2.]"
_VECTOR = re.compile(r"(?:array\()?(?:'\w',\s*+)?[\[(]([^\[\]()]*+)[\])]\)?$")
#: rows that are looked at
ROWS = 20


@dataclass(frozen=True)
class VectorCells:
    """How the cells of a table are split.

    separator: between cells;  header: cells of the line with the names
    lengths: of the vector in each column, None for a cell of another kind
    names: one for each element of each column; "" for an element that is no number
    """

    separator: str
    header: tuple[str, ...]
    lengths: tuple[int | None, ...]
    names: tuple[tuple[str, ...], ...]

    def __call__(self, lines: Iterable[str]) -> Iterator[str]:
        """The lines with a cell for each element; other lines without their quotes."""
        for line in lines:
            cells = cells_of(line, self.separator)
            if tuple(cells) == self.header:
                yield self._join(self.names)
                continue
            parts = [
                [cell] if length is None else _elements(cell) or []
                for cell, length in zip(cells, self.lengths, strict=False)
            ]
            as_before = [*map(len, parts)] == [*map(len, self.names)]
            whole = as_before and len(cells) == len(parts)
            # without quotes a row of other vectors has another number of cells, and is no row
            yield self._join(parts) if whole else line.replace('"', "")

    def _join(self, parts: Iterable[Sequence[str]]) -> str:
        kept = (
            cell
            for names, part in zip(self.names, parts, strict=True)
            for name, cell in zip(names, part, strict=True)
            if name
        )
        return self.separator.join(f'"{c}"' if self.separator in c else c for c in kept) + "\n"


def vectors_in_cells(lines: Sequence[str]) -> VectorCells | None:
    """How the cells of a table with vectors are split, from its first lines; None: without any."""
    filled = [line for line in lines if line.strip()][: ROWS + 1]
    if len(filled) < 3 or not any(sign in filled[1] for sign in "[("):
        return None
    for separator in SEPARATORS:
        header, *rows = (cells_of(line, separator) for line in filled)
        if separator == " " or any(len(row) != len(header) for row in rows):
            continue
        columns = [[_elements(cell) for cell in column] for column in zip(*rows, strict=True)]
        lengths = tuple(_length_of(column) for column in columns)
        if any(n is not None for n in lengths):
            return VectorCells(separator, tuple(header), lengths, _names(header, lengths, rows[0]))
    return None


def _elements(cell: str) -> list[str] | None:
    """The elements of a vector; None: the cell holds none."""
    match = _VECTOR.match(cell.strip())
    if match is None:
        return None
    inside = match[1].strip()
    parts = inside.split(",") if "," in inside else inside.split()
    return [part.strip(" '\"") for part in parts if part.strip()]


def _length_of(column: Sequence[list[str] | None]) -> int | None:
    """The length of all vectors of a column; None: some cell holds none, or lengths differ."""
    lengths = {None if elements is None else len(elements) for elements in column}
    return lengths.pop() if len(lengths) == 1 else None


def _names(
    header: Sequence[str], lengths: Sequence[int | None], row: Sequence[str]
) -> tuple[tuple[str, ...], ...]:
    """The names of all elements: of joints, where one column names as many, else by number."""
    vectors = [
        _elements(cell) if n is not None else None for cell, n in zip(row, lengths, strict=True)
    ]
    texts = [v for v in vectors if v and not any(is_number(e, False) for e in v)]
    out: list[tuple[str, ...]] = []
    for name, vector in zip(header, vectors, strict=True):
        joints = texts[0] if len(texts) == 1 and vector and len(vector) == len(texts[0]) else None
        if vector is None:
            out.append((name,))
        elif vector in texts:
            out.append(("",) * len(vector))
        elif joints:
            out.append(tuple(f"{joint}.{name}" for joint in joints))
        else:
            out.append(tuple(f"{name}[{k}]" for k in range(len(vector))))
    return tuple(out)

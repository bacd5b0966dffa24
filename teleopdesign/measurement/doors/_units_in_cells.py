"""Text tables with a unit behind each number, as MATLAB writes durations of a timetable.

Time,Angle,Torque                  Time,Angle,Torque
0.00 sec,12.1 deg,0.31   becomes   0.00,12.1,0.31     in s, deg and without a unit
0.01 sec,12.2 deg,0.30             0.01,12.2,0.30
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ._dialect import SEPARATORS, cells_of
from ._header import bare_unit, is_unit_cell

#: a number and a unit behind it
_READING = re.compile(
    r"([-+]?(?:\d++(?:[.,]\d*+)?|[.,]\d++)(?:[eE][-+]?\d++)?) ?+([^\W\d_].*|[°%].*)$"
)
#: rows that are looked at
ROWS = 20


@dataclass(frozen=True)
class UnitCells:
    """How the cells of a table are freed of their units.

    separator: between cells;  header: cells of the line with the names
    written: the unit behind each number of a column, None for a column without one
    """

    separator: str
    header: tuple[str, ...]
    written: tuple[str | None, ...]

    @property
    def units(self) -> Mapping[str, str]:
        """Column -> its unit, as the package writes it."""
        both = zip(self.header, self.written, strict=True)
        return {name: bare_unit(unit) for name, unit in both if unit is not None}

    def __call__(self, lines: Iterable[str]) -> Iterator[str]:
        """The lines without the units of these columns; lines of another form as they are."""
        for line in lines:
            cells = cells_of(line, self.separator)
            whole = len(cells) == len(self.header) and tuple(cells) != self.header
            if not whole or '"' in line and self.separator in "".join(cells):
                yield line
                continue
            bare = (
                cell if unit is None else cell.removesuffix(unit).rstrip()
                for cell, unit in zip(cells, self.written, strict=True)
            )
            yield self.separator.join(bare) + "\n"


def units_in_cells(lines: Sequence[str]) -> UnitCells | None:
    """How the cells of a table are freed of their units; None: it has none in its first lines."""
    filled = [line for line in lines if line.strip()][: ROWS + 1]
    for separator in SEPARATORS:
        header, *rows = (cells_of(line, separator) for line in filled or [""])
        if separator == " " or len(rows) < 2 or len(header) < 2:
            continue
        if any(len(row) != len(header) for row in rows) or any(map(_READING.match, header)):
            continue
        written = tuple(_unit_of(column) for column in zip(*rows, strict=True))
        if any(written):
            return UnitCells(separator, tuple(header), written)
    return None


def _unit_of(column: Sequence[str]) -> str | None:
    """The unit behind all numbers of a column; None: they have none, or several."""
    matches = [_READING.match(cell) for cell in column]
    units = {None if match is None else match[2] for match in matches}
    unit = units.pop() if len(units) == 1 else None
    return unit if unit and is_unit_cell(bare_unit(unit)) else None

"""Names and units of columns from the rows above a table: titles, groups, names and units."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ...base.units import is_unit
from ..column_names import unit_of_text
from ..limits import HALF

_BRACKETED = re.compile(r"[(\[{<][^()\[\]{}<>]*+[)\]}>]$")
#: a cell that says what it states: "Unit: deg", "Type: double"
_KEYED = re.compile(r"([^\W\d][\w ]*+):(?!:)\s*+(.*)$")
#: labels of a row above a table that holds the names, and of one that holds the units
NAME_LABELS = ("name", "names", "channel name", "signal name")
UNIT_LABELS = ("unit", "units")


def bare_unit(cell: str) -> str:
    """The unit in a cell of a row of units, without brackets, as the package writes units."""
    bare = cell.strip("[](){}<> ")
    return unit_of_text(bare) or bare


def is_unit_cell(cell: str) -> bool:
    """Whether a cell may belong to a row of units: a unit, with or without brackets, or empty."""
    bare = cell.strip("[](){}<> ")
    return not bare or bare in ("-", "counts", "ticks") or is_unit(bare)


def is_row_of_units(cells: Sequence[str], names: Sequence[str]) -> bool:
    """Whether a row below `names` holds units: all in brackets, or most of them known units."""
    filled = [cell for cell in cells if cell]
    if not filled or not any(names):
        return False
    if all(map(is_unit_cell, filled)) or all(map(_BRACKETED.match, filled)):
        return True
    known = sum(unit_of_text(cell.strip("[](){}<> ")) is not None for cell in filled)
    # letters such as "t", "a", "v" are names as well as units: names above them are no units
    above = sum(unit_of_text(name) is not None for name in names)
    return known > HALF * len(filled) and above < known


def names_and_units(rows: Sequence[Sequence[str]]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of the columns from the rows of text above a table.

    The rows are as wide as the table. A column without a name takes the name in the row above.
    Columns with the same name get the title of their group: "Motor Angle", "Bench Angle". A title
    stands above the first column of its group.
    """
    above, units = _without_keyed_rows(rows)
    if len(above) > 1 and not units and is_row_of_units(above[-1], above[-2]):
        units = tuple(bare_unit(cell) for cell in above.pop())
    names = list(above.pop()) if above else []
    while above and not all(names) and sum(map(bool, above[-1])) > 1:
        row = above.pop()
        names = [name or upper for name, upper in zip(names, row, strict=False)]
    filled = [name for name in names if name]
    if above and len(set(filled)) < len(filled) and sum(map(bool, above[-1])) > 1:
        # only the first of merged cells holds the title of a group
        titles: list[str] = []
        for title in above[-1]:
            titles.append(title or (titles[-1] if titles else ""))
        twice = {name for name in filled if filled.count(name) > 1}
        names = [
            f"{title} {name}" if name in twice and title else name
            for name, title in zip(names, titles, strict=True)
        ]
    return tuple(names), units


def _without_keyed_rows(
    rows: Sequence[Sequence[str]],
) -> tuple[list[Sequence[str]], tuple[str, ...]]:
    """The rows without those in which each cell says what it states, and the units among these.

    Simulink writes such rows below the names: "Unit: deg, Unit: N*m", "Interp: zoh, Interp: zoh".
    """
    plain: list[Sequence[str]] = []
    units: tuple[str, ...] = ()
    for row in rows:
        keyed = [_KEYED.match(cell) for cell in row if cell]
        keys = {match[1].strip().casefold() if match else "" for match in keyed}
        if not plain or len(keys) != 1 or keys == {""}:
            plain.append(row)
        elif keys & {*UNIT_LABELS}:
            units = tuple(bare_unit(cell.partition(":")[2]) for cell in row)
    return plain, units


def names_of_labelled_rows(
    rows: Sequence[Sequence[str]],
) -> tuple[tuple[str, ...], tuple[str, ...]] | None:
    """Names and units where each row above the table says what it holds; None: they do not.

    Scopes of controllers write such rows: "Name; Axis 1.ActPos", "Data-Type; REAL64",
    "SampleTime[ms]; 1". The times stand below the labels, and a label may stand before each column.
    """
    named = next((row for row in rows if row[0].casefold() in NAME_LABELS), None)
    if named is None:
        return None
    labels = [k for k, cell in enumerate(named) if cell == named[0]]
    rows = [row for row in rows if row[0] and all(row[k] == row[0] for k in labels)]
    names = tuple("time" if k in labels else cell for k, cell in enumerate(named))
    units = [""] * len(names)
    for row in rows:
        bracketed = _BRACKETED.search(row[0])
        if "time" in row[0].casefold() and bracketed and is_unit(bare_unit(bracketed[0])):
            for k in labels:
                units[k] = bare_unit(bracketed[0])
        if row[0].casefold() in UNIT_LABELS:
            units = [u or bare_unit(c) * is_unit_cell(c) for u, c in zip(units, row, strict=True)]
    return names, tuple(units)

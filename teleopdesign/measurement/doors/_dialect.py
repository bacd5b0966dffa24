"""How a text table is written, judged from its first rows: separator, decimal sign, encoding."""

from __future__ import annotations

import csv
import gzip
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, cast

import numpy as np

from ...base.errors import ExperimentError, quote
from ..encoder import is_most
from ..limits import HALF, SEVERAL
from ._cells import is_number, seconds_of
from ._encoding import encoding_of
from ._header import NAME_LABELS, bare_unit, names_and_units, names_of_labelled_rows
from ._log import number_names

COMMENTS = ("#", "%", "//")
SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", " ": "spaces"}
#: bytes from which the dialect is read
LOOKED_AT = 65_536
#: lines of which there are few in so many bytes, and most bytes of a file that is then read whole
FEW_LINES, MOST_OF_FEW_LINES = 128, 20_000_000
#: lines above a table that are kept, for what they say of constants
MOST_REMARKS = 100


@dataclass(frozen=True)
class Dialect:
    """How a text table is written.

    separator: between cells;  comma: the decimal sign is a comma
    header, units: name and unit of each column;  first: line of the first row of numbers, from 0
    named: the file has a header;  dates: columns of dates or times of day
    remarks: lines above the first row of numbers
    labels: texts with which they begin, as does each header that repeats in the table
    """

    encoding: str
    separator: str
    comma: bool
    header: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    named: bool = True
    dates: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    labels: frozenset[str] = frozenset()


def first_lines(path: Path, file: str) -> tuple[str, list[str], bool]:
    """The encoding of a file, its first lines, and whether these are all.

    A file of few and long lines is read on: each of them may be a signal.
    raises ExperimentError: the file has no text
    """
    with open_bytes(path) as stream:
        raw = stream.read(LOOKED_AT)
        if len(raw) == LOOKED_AT and raw.count(b"\n") + raw.count(b"\r") < FEW_LINES:
            raw += stream.read(MOST_OF_FEW_LINES)
        whole = not stream.read(1)
    encoding = encoding_of(raw, file, whole=whole)
    text = raw.decode(encoding, errors="ignore").replace("\r\n", "\n").replace("\r", "\n")
    lines = text.split("\n")
    if not whole:
        lines = lines[:-1]
    if not any(line.strip() for line in lines):
        raise ExperimentError(
            f"{file}: found no header, expected a first row that names the columns"
        )
    return encoding, lines, whole


def dialect_of(lines: Sequence[str], encoding: str, file: str) -> Dialect:
    """How a text table is written, judged from its first lines."""
    body = [line for line in lines if line.strip() and not line.lstrip().startswith(COMMENTS)]
    separator, comma = separator_of(body[1:] or body)
    first, width = _first_row(lines, separator, comma)
    if first >= len(lines):
        _refuse_without_rows(lines, separator, file)
    header, units = _header(lines[:first], separator, width, comma)
    named = bool(header)
    if not named:
        header = tuple(f"column {k + 1}" for k in range(width))
    elif header.count("") == 1:  # drives and pandas leave the name of the first column out
        header = tuple(name or f"column {k + 1}" for k, name in enumerate(header))
    elif len(header) == 2 < width - 1:  # a time and an array, as simulation tools export them
        header = (header[0], *(f"{header[1]}(:,{k + 1})" for k in range(width - 1)))
    names = number_names(header)
    cells = cells_of(lines[first], separator)
    dates = tuple(
        name
        for name, cell in zip(names, cells, strict=False)
        if not is_number(cell, comma) and seconds_of(cell) is not None
    )
    remarks = tuple(line.strip() for line in lines[:first] if line.strip())[:MOST_REMARKS]
    labels = frozenset(cells_of(line, separator)[0] for line in lines[:first] if line.strip())
    labels -= {"", cells[0]}  # a row may begin with a text too
    return Dialect(encoding, separator, comma, names, units, first, named, dates, remarks, labels)


def _first_row(lines: Sequence[str], separator: str, comma: bool) -> tuple[int, int]:
    """Line of the first row of numbers, and the most frequent number of cells in such rows.

    Numbers above a table (a rate, a count of samples) differ from its rows: another number of
    cells, or fewer than `SEVERAL` such rows in succession.
    """
    widths = {
        k: len(cells)
        for k, line in enumerate(lines)
        if line.strip() and not line.lstrip().startswith(COMMENTS)
        if _is_data(cells := cells_of(line, separator), comma)
    }
    if not widths:
        return len(lines), 0
    counts = Counter(widths.values())
    width = max(counts, key=lambda w: (counts[w], w))
    rows = [k for k, w in widths.items() if w == width]
    filled = [k for k, line in enumerate(lines) if line.strip()]
    place = {k: n for n, k in enumerate(filled)}
    begins = [n for n, k in enumerate(rows) if n == 0 or place[k] != place[rows[n - 1]] + 1]
    lengths = np.diff([*begins, len(rows)])
    whole = np.flatnonzero(lengths >= min(SEVERAL, lengths.max()))
    here = begins[int(whole[0])]
    # labelled rows of numbers ("SampleTime[ms]; 1", "Samples; 100; 100") belong to what stands
    # above; a single one without more labels is a row with a garbled cell
    begin = [cells_of(lines[k], separator)[0] for k in rows[here:]]
    labelled = [bool(cell) and not is_value(cell, comma) for cell in begin]
    count = labelled.index(False) if False in labelled else 0
    above = (cells_of(line, separator) for line in lines[: rows[here]])
    if any(cells and cells[0].casefold() in NAME_LABELS for cells in above) or (
        count > 1 and labelled.count(True) < HALF * len(labelled)
    ):
        here += count
    return rows[here], width


def _refuse_without_rows(lines: Sequence[str], separator: str, file: str) -> None:
    filled = [line for line in lines if line.strip()]
    if len(filled) <= 1:
        raise ExperimentError(f"{file}: found a header and no rows, expected at least 64")
    cell = next((c for c in cells_of(filled[1], separator) if c), "")
    raise ExperimentError(
        f"{file}: not a table of numbers: row 1: found {quote(cell)}, expected a number"
    )


def separator_of(lines: Sequence[str]) -> tuple[str, bool]:
    """The separator, and whether the decimal sign is a comma: the choice with most numbers."""
    some = lines[-40:]
    best, chosen = (-1.0, 0), (",", False)
    for separator in SEPARATORS:
        for comma in (False, True):
            if comma and separator == ",":
                continue
            rows = [cells_of(line, separator) for line in some]
            widths = [len(row) for row in rows]
            width = max(set(widths), key=widths.count) if widths else 0
            cells = [c for row in rows for c in row if c]
            good = sum(is_value(c, comma) for c in cells) / max(len(cells), 1)
            even = widths.count(width) / max(len(widths), 1)
            # of equally good readings, blanks are within cells: "2026-11-20 21:03:04.5"
            score = (round(good * even, 3), width if separator != " " else 1)
            # a table has two columns or more
            if width > 1 and score > best:
                best, chosen = score, (separator, comma)
    return chosen


def cells_of(line: str, separator: str) -> list[str]:
    """The cells of a line, without spaces around them."""
    line = without_end(line.strip("\r\n"), separator)
    if separator == " ":
        return line.split()
    if '"' in line:
        return [
            c.strip() for c in next(csv.reader([line], delimiter=separator, skipinitialspace=True))
        ]
    cells = [c.strip() for c in line.split(separator)]
    return cells


def without_end(line: str, separator: str) -> str:
    """A line without a semicolon that ends it and separates nothing, as in a MATLAB matrix."""
    end = line.rstrip()
    return end[:-1] if separator != ";" and end.endswith(";") else line


def is_value(cell: str, comma: bool) -> bool:
    return is_number(cell, comma) or seconds_of(cell) is not None


def _is_data(cells: Sequence[str], comma: bool) -> bool:
    """Whether half of a row's cells are numbers or dates: a signal may be named beside them."""
    filled = [c for c in cells if c]
    return bool(filled) and not is_most(np.array([not is_value(c, comma) for c in filled]))


def _header(
    before: Sequence[str], separator: str, width: int, comma: bool
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units from the lines before the first row of numbers."""
    plain = [line for line in before if line.strip()]
    above = _without_constants([_cells_above(line, separator, width) for line in plain], width)
    wide = [tuple(cells) for cells in above if len(cells) == width]
    rows = [cells for cells in wide if not _is_data(cells, comma)]
    cells = above[-1] if above else []
    if (labelled := names_of_labelled_rows(wide)) is not None:
        return labelled
    if len(cells) > width > 1 and not any(is_number(c, True) or not c for c in cells):
        rows.append(tuple(cells[:width]))  # without names of empty columns, such as "Comment"
    if not rows:
        last = plain[-1] if plain and not plain[-1].lstrip().startswith(COMMENTS) else ""
        names = cells_of(last, separator) if last else []
        is_title = len(names) < 2 < width and len(last.split()) < width
        return (() if is_title or _is_data(names, comma) else tuple(names)), ()
    joined, units_by_name = names_and_units(rows)
    for label, *units in rows[:-1]:  # a row of units that says so itself: "Y_Unit_Label"
        if not units_by_name and "unit" in label.lower():
            return rows[-1], ("", *map(bare_unit, units))
    return joined, units_by_name


def _cells_above(line: str, separator: str, width: int) -> list[str]:
    """The cells of a line above a table with `width` columns, without the sign of a comment."""
    text = line.lstrip(" ")  # not tabs: the first cell of a row of titles may be empty
    for mark in COMMENTS:
        text = text.removeprefix(mark)
    cells = cells_of(text.strip() if separator == " " else text.strip("\n"), separator)
    while len(cells) > width and not cells[-1]:
        cells = cells[:-1]
    return cells


def _without_constants(above: list[list[str]], width: int) -> list[list[str]]:
    """Rows of names and units without constants that stand beside the table, as scopes write them.

    X, CH1, CH2, Start, Step
    Sequence, V, V, -0.6, 0.001
    0, 1.23, 0.52,
    """
    out, beside = [*above], 0
    for k, cells in reversed([*enumerate(above)]):
        texts = next((n for n, cell in enumerate(cells) if is_number(cell, True)), len(cells))
        if not beside and len(cells) > max(width, 2) and width - 1 <= texts < len(cells):
            beside = len(cells) - texts
        names = cells[: len(cells) - beside]
        if beside and width - 1 <= len(names) <= width and texts >= len(names):
            out[k] = [*names, ""][:width]  # rows of the table may end with a separator
    return out


def open_bytes(path: Path) -> IO[bytes]:
    """Open the bytes of a file; a file whose name ends with .gz is unpacked."""
    if path.name.lower().endswith(".gz"):
        return cast(IO[bytes], gzip.open(path, "rb"))
    return path.open("rb")

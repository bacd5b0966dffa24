"""Comma-separated text: read fast if well-formed; if not, the row and the column are named."""

import csv
import gzip
import io
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from ..errors import ExperimentError, quoted

_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}


def read_csv(
    path: Path,
    file: str,
    wanted: Mapping[str, str],
    require_columns: Callable[[Iterable[str], str, Mapping[str, str]], None],
) -> dict[str, NDArray[np.float64]]:
    """The wanted columns as written, each of shape (n,); `.gz` is unpacked on the way.

    raises ExperimentError: no header, other separators, a cell that is no number, ragged rows
    """
    try:
        with _opened(path) as stream:
            header = _header(stream.readline(), file)
            require_columns(header, file, wanted)
            names = list(wanted)
            places = [_place(header, name, file, wanted) for name in names]
            cells = np.loadtxt(
                _checked_lines(stream, len(header), file),
                delimiter=",",
                comments=None,
                quotechar='"',
                usecols=places,
                ndmin=2,
            )
    except UnicodeDecodeError as problem:
        raise ExperimentError(f"{file}: not UTF-8 text (byte {problem.start})") from None
    except ValueError as problem:
        raise _first_bad_cell(path, file, wanted, problem) from None
    return {name: np.ascontiguousarray(cells[:, i]) for i, name in enumerate(names)}


def _opened(path: Path) -> IO[str]:
    if path.name.lower().endswith(".gz"):
        return io.TextIOWrapper(gzip.open(path, "rb"), encoding="utf-8-sig")
    return path.open(encoding="utf-8-sig")


def _header(line: str, file: str) -> list[str]:
    if not line.strip():
        raise ExperimentError(
            f"{file}: found no header, expected a first row that names the columns"
        )
    for separator, name in _OTHER_SEPARATORS.items():
        if separator in line and "," not in line:
            raise ExperimentError(f"{file}: found columns separated by {name}, expected commas")
    header = [cell.strip() for cell in next(csv.reader([line], skipinitialspace=True))]
    if all(_is_number(cell) for cell in header):
        raise ExperimentError(
            f"{file}: found numbers in the first row, expected a header that names the columns"
        )
    return header


def _place(header: list[str], name: str, file: str, wanted: Mapping[str, str]) -> int:
    if header.count(name) > 1:
        raise ExperimentError(
            f"{file}: {wanted[name]}: found {header.count(name)} columns {quoted(name)}, "
            "expected one"
        )
    return header.index(name)


def _checked_lines(stream: Iterable[str], columns: int, file: str) -> Iterator[str]:
    """The data lines; a line with more or fewer commas than the header stops the reading."""
    commas = columns - 1
    row = 0
    for line in stream:
        row += 1
        if line.count(",") != commas and '"' not in line:
            if not line.strip():
                row -= 1  # an empty line, skipped
                continue
            raise ExperimentError(
                f"{file}: row {row}: found {line.count(',') + 1} cells, "
                f"expected {columns} as in the header"
            )
        yield line
    if row == 0:
        raise ExperimentError(f"{file}: found a header and no rows, expected at least 64")


def _first_bad_cell(
    path: Path, file: str, wanted: Mapping[str, str], problem: ValueError
) -> ExperimentError:
    """Go through the file again, slowly, for the cell that stopped the fast reader."""
    with _opened(path) as stream:
        rows = csv.reader(stream, skipinitialspace=True)
        header = [cell.strip() for cell in next(rows)]
        filled = (cells for cells in rows if cells)
        for row, cells in enumerate(filled, start=1):
            for column, channel in wanted.items():
                place = header.index(column)
                cell = cells[place] if place < len(cells) else ""
                if not _is_number(cell):
                    return ExperimentError(
                        f"{file}: {channel}: column {quoted(column)}, row {row}: "
                        f"found {quoted(cell) if cell else 'an empty cell'}, expected a number"
                    )
    return ExperimentError(f"{file}: not a table of numbers: {problem}")


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell  # Python reads "1_000", a table of numbers does not hold it

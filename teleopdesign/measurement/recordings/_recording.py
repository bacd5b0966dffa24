"""What a public recording is: where its files lie, how they become tables, a plain first model.

Units, signs and rates are those that the authors state, checked against the recordings themselves;
digits beyond the sensors' resolution are rounded away.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RawFile:
    """One published file: "OWNER/NAME" of its repository, commit, path in it, sha256."""

    repository: str
    commit: str
    path: str
    sha256: str


@dataclass(frozen=True)
class Recording:
    """convert: writes the record files into a folder; experiment: the text of experiment.toml."""

    files: tuple[RawFile, ...]
    convert: Callable[[list[Path], Path], None]
    experiment: str


def write(path: Path, columns: Mapping[str, tuple[NDArray[np.float64], int]]) -> None:
    """Columns (values, digits after the point) as comma-separated text with a header."""
    np.savetxt(
        path,
        np.column_stack([values for values, _ in columns.values()]),
        fmt=[f"%.{digits}f" for _, digits in columns.values()],
        delimiter=",",
        header=",".join(columns),
        comments="",
    )


def count_rows(values: NDArray[np.float64], rate: float) -> tuple[NDArray[np.float64], int]:
    """Time in s of one row of `values` after the other, at a rate in Hz: a column for `write`."""
    return np.arange(len(values)) / rate, 3

"""Description of a public recording: its files, their conversion to tables, a simple first model.

Units, signs and rates are those that the authors state, checked against the recordings. Values are
rounded to the resolution of the sensors.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RawFile:
    """One published file: repository "OWNER/NAME", commit, path in the repository, sha256."""

    repository: str
    commit: str
    path: str
    sha256: str


@dataclass(frozen=True)
class Recording:
    """A public recording.

    files: the published files
    convert: function that writes the record files into a folder
    experiment: the text of experiment.toml
    """

    files: tuple[RawFile, ...]
    convert: Callable[[list[Path], Path], None]
    experiment: str


def write(path: Path, columns: Mapping[str, tuple[NDArray[np.float64], int]]) -> None:
    """Write columns (values, digits after the point) as comma-separated text with a header."""
    np.savetxt(
        path,
        np.column_stack([values for values, _ in columns.values()]),
        fmt=[f"%.{digits}f" for _, digits in columns.values()],
        delimiter=",",
        header=",".join(columns),
        comments="",
    )


def count_rows(values: NDArray[np.float64], rate: float) -> tuple[NDArray[np.float64], int]:
    """Time in s of successive rows of `values` at a rate in Hz, as a column for `write`."""
    return np.arange(len(values)) / rate, 3

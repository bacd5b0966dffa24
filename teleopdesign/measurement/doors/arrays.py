"""numpy files (.npz): arrays by name, columns of matrices ("data(:,3)"); nothing is unpickled."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import ExperimentError, quote
from ._log import MOST_BYTES, Log, Part, log_of_arrays, parts_of, refuse_damage, refuse_size

_KIND = ".npz file"


def open_arrays(path: Path, file: str) -> Log:
    """Open an .npz file; raises ExperimentError: a damaged or too large file.

    `Log.read` raises ExperimentError for an array of Python objects.
    """
    columns: dict[str, tuple[str, Part]] = {}
    with refuse_damage(_KIND, file), zipfile.ZipFile(path) as packed:
        for entry in packed.infolist():
            shape = _shape(packed, entry)
            if shape is None:
                continue
            refuse_size(max(shape, default=0), file)
            if entry.file_size > MOST_BYTES:
                raise ExperimentError(f"{file}: found {entry.file_size:.3g} bytes unpacked")
            columns |= parts_of(entry.filename.removesuffix(".npy"), shape)

    def load(names: Sequence[str]) -> dict[str, Any]:
        out: dict[str, Any] = {}
        with refuse_damage(_KIND, file), np.load(path, allow_pickle=False) as content:
            for name in names:
                try:
                    out[name] = content[name]
                except (ValueError, KeyError) as problem:
                    kind = "holds Python objects" if "pickle" in str(problem) else str(problem)
                    raise ExperimentError(
                        f"{file}: {quote(name)}: {kind}, expected numbers"
                    ) from None
        return out

    return log_of_arrays(columns, load, file)


def _shape(packed: zipfile.ZipFile, entry: zipfile.ZipInfo) -> tuple[int, ...] | None:
    """The shape that an array states in its first bytes; None: the entry is no array."""
    if not entry.filename.endswith(".npy"):
        return None
    with packed.open(entry) as stream:
        version = np.lib.format.read_magic(stream)
        head = np.lib.format.read_array_header_1_0
        if version >= (2, 0):
            head = np.lib.format.read_array_header_2_0
        shape: tuple[int, ...] = head(stream)[0]
        return shape

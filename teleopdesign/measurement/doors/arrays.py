"""numpy files (.npz): arrays by name, columns of matrices ("data(:,3)"); nothing is unpickled."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import ExperimentError, quote
from ._log import MOST_BYTES, Log, part, parts_of, refuse_damage, refuse_size

_KIND = ".npz file"


def open_arrays(path: Path, file: str) -> Log:
    """Open an .npz file; raises ExperimentError: a damaged or too large file.

    `Log.read` raises ExperimentError for an array of Python objects.
    """
    columns: dict[str, tuple[str, int | None]] = {}
    with refuse_damage(_KIND, file), zipfile.ZipFile(path) as packed:
        for entry in packed.infolist():
            name = entry.filename.removesuffix(".npy")
            shape = _shape(packed, entry)
            if shape is None:
                continue
            refuse_size(max(shape, default=0), file)
            if entry.file_size > MOST_BYTES:
                raise ExperimentError(f"{file}: found {entry.file_size:.3g} bytes unpacked")
            columns |= parts_of(name, shape) or {name: (name, None)}

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        out: dict[str, Any] = {}
        with refuse_damage(_KIND, file), np.load(path, allow_pickle=False) as content:
            for name in wanted:
                array, column = columns[name]
                try:
                    out[name] = part(content[array], column)
                except (ValueError, KeyError, IndexError) as problem:
                    kind = "holds Python objects" if "pickle" in str(problem) else str(problem)
                    raise ExperimentError(
                        f"{file}: {quote(name)}: {kind}, expected numbers"
                    ) from None
        return out

    return Log(tuple(columns), read)


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

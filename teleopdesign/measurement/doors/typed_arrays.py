"""Files of typed arrays: numpy (.npz), HDF5 and parquet.

Arrays by name, columns of matrices ("data(:,3)"), datasets of groups ("robot/q(:,2)") and fields of
compounds. Nothing is unpickled, and datasets that are stored in other files (external storage,
virtual datasets) are refused: a log is one file.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import ExperimentError, quote
from ..column_names import unit_of_text
from ._log import (
    MOST_BYTES,
    MOST_COLUMNS,
    ArrayPart,
    Log,
    log_of_arrays,
    optional,
    parts_of,
    refuse_damage,
    refuse_size,
)
from .shapes._table import MOST_ROWS

#: how MATLAB begins its files, in front of what HDF5 writes
_MATLAB = b"MATLAB"
#: names of the attribute that holds a unit, in lower case
UNIT_KEYS = ("units", "unit")
#: attribute by which MATLAB marks one of its objects; its numbers lie elsewhere in the file
_OBJECT = "MATLAB_object_decode"


def open_arrays(path: Path, file: str) -> Log:
    """Open an .npz file; raises ExperimentError: a damaged or too large file.

    `Log.read` raises ExperimentError for an array of Python objects.
    """
    columns: dict[str, tuple[str, ArrayPart]] = {}
    with refuse_damage(".npz file", file), zipfile.ZipFile(path) as packed:
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
        with refuse_damage(".npz file", file), np.load(path, allow_pickle=False) as content:
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


def open_hdf5(path: Path, file: str) -> Log:
    """Open an HDF5 file, or a MAT file of version 7.3."""
    h5py = optional("h5py", file)
    columns: dict[str, tuple[str, ArrayPart]] = {}
    units: dict[str, str] = {}
    with path.open("rb") as stream:
        turned = stream.read(len(_MATLAB)) == _MATLAB
    objects: list[str] = []
    with refuse_damage("HDF5 file", file), h5py.File(path, "r") as content:
        names: list[str] = []

        def visit(name: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and len(names) < MOST_COLUMNS:
                names.append(name)

        content.visititems(visit)
        for name in names:
            if name.startswith("#"):  # where MATLAB keeps its cells
                continue
            item = content[name]
            if item.dtype == h5py.ref_dtype:  # fields of an array of structs lie elsewhere
                continue
            unit = _unit(item)
            if _OBJECT in item.attrs:
                objects.append(name)
            elif item.dtype.names:
                columns |= {f"{name}.{field}": (name, field) for field in item.dtype.names}
            else:
                # MATLAB writes a matrix column by column: here it is transposed
                shape = item.shape[::-1] if turned else item.shape
                columns |= (parts := parts_of(name, shape))
                units |= dict.fromkeys(parts, unit) if unit else {}

    def load(names: Sequence[str]) -> dict[str, Any]:
        with refuse_damage("HDF5 file", file), h5py.File(path, "r") as content:
            return {name: _values(content[name], name) for name in names}

    def _values(item: Any, name: str) -> Any:
        if item.external or item.is_virtual:
            raise ExperimentError(
                f"{file}: dataset {quote(name)} lies in another file, expected one file"
            )
        refuse_size(max(item.shape, default=0), file)
        return item[()].T if turned else item[()]

    return log_of_arrays(columns, load, file, units=units, objects=objects)


def _unit(item: Any) -> str | None:
    """The unit in the attributes of a dataset; None: no attribute states one."""
    for key, value in item.attrs.items():
        if key.lower() in UNIT_KEYS:
            text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
            if isinstance(text, str) and text.strip():
                return unit_of_text(text) or text.strip()
    return None


def open_parquet(path: Path, file: str) -> Log:
    """Open a parquet file; raises ExperimentError: a damaged file, or pyarrow is missing."""
    parquet = optional("pyarrow.parquet", file)
    with refuse_damage("parquet file", file):
        schema = parquet.read_schema(path)
        names = tuple(schema.names)
        # dates and durations are read in seconds, whatever their names say: "time_ms"
        timed = [n for n, kind in zip(names, map(str, schema.types), strict=True)
                 if kind.startswith(("timestamp", "duration", "time32", "time64"))]  # fmt: skip
        content = parquet.ParquetFile(path)
        refuse_size(content.metadata.num_rows, file)
        first = next(content.iter_batches(MOST_ROWS), None)
        columns = dict(zip(names, first.columns, strict=True)) if first is not None else {}
        sample = {n: c.to_numpy(zero_copy_only=False) for n, c in columns.items()}

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        with refuse_damage("parquet file", file):
            table = parquet.read_table(path, columns=list(wanted))
            return {name: table.column(name).to_numpy() for name in wanted}

    return Log(names, read, dict.fromkeys(timed, "s"), sample=sample)

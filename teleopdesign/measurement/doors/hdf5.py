"""HDF5 files: datasets ("robot/q"), columns of matrices ("robot/q(:,2)") and fields of compounds.

Datasets that are stored in other files (external storage, virtual datasets) are refused: a log is
one file.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...base.errors import ExperimentError, quote
from ..column_names import unit_of_text
from ._log import (
    MOST_COLUMNS,
    Log,
    Part,
    log_of_arrays,
    optional,
    parts_of,
    refuse_damage,
    refuse_size,
)

_KIND = "HDF5 file"
#: how MATLAB begins its files, in front of what HDF5 writes
_MATLAB = b"MATLAB"
#: names of the attribute that holds a unit, in lower case
UNIT_KEYS = ("units", "unit")
#: attribute by which MATLAB marks one of its objects; its numbers lie elsewhere in the file
_OBJECT = "MATLAB_object_decode"


def open_hdf5(path: Path, file: str) -> Log:
    """Open an HDF5 file, or a MAT file of version 7.3."""
    h5py = optional("h5py", file)
    columns: dict[str, tuple[str, Part]] = {}
    units: dict[str, str] = {}
    with path.open("rb") as stream:
        turned = stream.read(len(_MATLAB)) == _MATLAB
    objects: list[str] = []
    with refuse_damage(_KIND, file), h5py.File(path, "r") as content:
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
        with refuse_damage(_KIND, file), h5py.File(path, "r") as content:
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

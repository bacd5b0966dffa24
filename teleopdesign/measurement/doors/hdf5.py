"""HDF5 files: datasets ("robot/q"), columns of matrices ("robot/q(:,2)"), fields of compound ones.

Datasets that lie in other files (external storage, external links, virtual datasets) are refused: a
log is one file.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import ExperimentError, quote
from ._log import Log, how_to_save, optional, part, parts_of, refuse_size, refusing_damage

_KIND = "HDF5 file"
#: datasets of one file that are listed
_MOST = 10_000
#: attribute by which MATLAB marks one of its objects; its numbers lie elsewhere in the file
_OBJECT = "MATLAB_object_decode"


def open_hdf5(path: Path, file: str) -> Log:
    """An HDF5 file, or a MAT file of version 7.3."""
    h5py = optional("h5py", file)
    columns: dict[str, tuple[str, int | str | None]] = {}
    objects: list[str] = []
    with refusing_damage(_KIND, file), h5py.File(path, "r") as content:
        names: list[str] = []

        def visit(name: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and len(names) < _MOST:
                names.append(name)

        content.visititems(visit)
        for name in names:
            if name.startswith("#"):  # where MATLAB keeps its cells
                continue
            item = content[name]
            if _OBJECT in item.attrs:
                objects.append(name)
            elif item.dtype.names:
                columns |= {f"{name}.{field}": (name, field) for field in item.dtype.names}
            else:
                columns |= parts_of(name, item.shape) or {name: (name, None)}
                if len(item.shape) == 2 and 1 not in item.shape:
                    columns[name] = (name, -1)

    if objects and not columns:
        raise ExperimentError(f"{file}: {how_to_save(objects[0])}")

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        with refusing_damage(_KIND, file), h5py.File(path, "r") as content:
            return {
                name: _values(content[columns[name][0]], name, columns[name][1]) for name in wanted
            }

    def _values(item: Any, name: str, column: int | str | None) -> Any:
        if item.external or item.is_virtual:
            raise ExperimentError(
                f"{file}: dataset {quote(name)} lies in another file, expected one file"
            )
        refuse_size(max(item.shape, default=0), file)
        if column == -1:
            return item[()]
        if isinstance(column, str):
            return item[column]
        return part(item[()], column)

    notes = tuple(f"{how_to_save(name)}; it is left out" for name in objects)
    return Log(tuple(columns), read, notes=notes)

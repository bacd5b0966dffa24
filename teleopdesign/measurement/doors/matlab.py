"""MATLAB files: variables, fields of structs ("log.q"), columns of matrices ("data(:,3)").

Version 7.3 is an HDF5 file. Only MATLAB can unpack a timetable or table: a message says how to save
it in another form.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...base.errors import ExperimentError
from ._log import Log, how_to_save, part, parts_of, refuse_damage, refuse_size
from ._mat_elements import check_elements
from .hdf5 import MOST_STRUCTS, open_hdf5

#: how an HDF5 file begins, at its first byte or behind a head of so many bytes
_HDF5, _HEAD = b"\x89HDF\r\n\x1a\n", 512
_KIND = "MAT file"
#: structs within structs that are looked into
_DEPTH = 4


def open_matlab(path: Path, file: str) -> Log:
    """Open a MAT file of any version."""
    from scipy.io import loadmat, whosmat

    if _is_hdf5(path):
        return open_hdf5(path, file)
    with refuse_damage(_KIND, file):
        check_elements(path)
        try:
            listed = whosmat(path)
            for _, shape, _ in listed:
                refuse_size(max(shape, default=0), file)
            structs = [name for name, _, kind in listed if kind == "struct"]
            objects = [name or "it" for name, _, kind in listed if kind in ("opaque", "object")]
            content = dict(loadmat(path, variable_names=structs)) if structs else {}
        except NotImplementedError:  # version 7.3 is an HDF5 file
            return open_hdf5(path, file)
    columns: dict[str, tuple[str, int | None]] = {}
    arrays: dict[str, Any] = {}
    units: dict[str, str] = {}
    for name, shape, kind in listed:
        if kind == "struct":
            fields = _fields(name, content[name], 0, units)
            arrays |= fields
            for field, values in fields.items():
                columns |= parts_of(field, np.shape(values))
        elif kind not in ("opaque", "object", "function", "cell"):
            # what is no column is listed too, so that a message can say what is wrong with it
            columns |= parts_of(name, shape) or {name: (name, None)}
            if len(shape) == 2 and 1 not in shape:
                columns[name] = (name, -1)
    if objects and not columns:
        raise ExperimentError(f"{file}: {how_to_save(objects[0])}")

    def read(wanted: Mapping[str, str]) -> Mapping[str, Any]:
        plain = [columns[n][0] for n in wanted if columns[n][0] not in arrays]
        with refuse_damage(_KIND, file):
            contents = loadmat(path, variable_names=list(dict.fromkeys(plain))) if plain else {}
        out = {}
        for name in wanted:
            array, column = columns[name]
            values = arrays[array] if array in arrays else contents[array]
            out[name] = values if column == -1 else part(values, column)
        return out

    notes = tuple(f"{how_to_save(name)}; it is left out" for name in objects)
    return Log(tuple(n for n in columns), read, units, notes)


def _is_hdf5(path: Path) -> bool:
    """Whether a file is HDF5, with the header of MATLAB 7.3 or without it."""
    with path.open("rb") as stream:
        head = stream.read(_HEAD + len(_HDF5))
    return head.startswith(_HDF5) or head[_HEAD:] == _HDF5


def _fields(name: str, value: Any, depth: int, units: dict[str, str]) -> dict[str, Any]:
    """Numeric fields of a struct, "log.q", including those of nested structs.

    units: gets the unit of each field for which the struct states one
    """
    array = np.asarray(value)
    if array.dtype.names and (signals := _signals(name, array, units)):
        return signals
    if array.dtype.names and array.size == 1 and depth < _DEPTH:
        contents: dict[str, Any] = {}
        for field in array.dtype.names:
            contents |= _fields(f"{name}.{field}", array.reshape(-1)[0][field], depth + 1, units)
        return contents
    if array.dtype.names and 1 < array.size <= MOST_STRUCTS and depth < _DEPTH:
        contents = {}
        for k, element in enumerate(array.reshape(-1), start=1):
            one = np.empty(1, dtype=array.dtype)
            one[0] = element
            contents |= _fields(f"{name}({k})", one, depth, units)
        return contents
    if array.dtype.kind in "fiub" and array.size > 1:
        return {name: array}
    return {}


def _signals(name: str, array: Any, units: dict[str, str]) -> dict[str, Any]:
    """Signals of structs that hold their names, "rec.Y.Torque cmd"; {} for other structs.

    A real-time system writes one struct per signal: `Name` or `label`, `Data` or `values`, `Unit`.
    """
    lower = {field.lower(): field for field in array.dtype.names}
    label = lower.get("name") or (lower.get("label") if array.size > 1 else None)
    data = lower.get("data") or lower.get("values")
    if label is None or data is None:
        return {}
    elements = list(array.reshape(-1))
    whole = [_text(e[label]).replace('"', "") for e in elements]
    short = [text.rpartition("/")[2] for text in whole]
    names = short if len(set(short)) == len(short) else whole
    signals: dict[str, Any] = {}
    for text, element in zip(names, elements, strict=True):
        values = np.asarray(element[data])
        if not text or values.dtype.kind not in "fiub" or values.size < 2:
            continue
        signals[f"{name}.{text}"] = values
        if "unit" in lower and (unit := _text(element[lower["unit"]])):
            units[f"{name}.{text}"] = unit
    return signals


def _text(value: Any) -> str:
    """The text in a field of a struct; "" for other content."""
    array = np.asarray(value)
    return str(array.reshape(-1)[0]).strip() if array.size == 1 and array.dtype.kind == "U" else ""

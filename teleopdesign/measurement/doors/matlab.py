"""MATLAB files: variables, fields of structs ("log.q"), columns of matrices ("data(:,3)").

Version 7.3 is an HDF5 file. Only MATLAB can unpack a timetable or table: a message says how to save
it in another form. scipy does not check the class of a matrix and the type of its numbers, and a
damaged file would end the process: the elements of a file of version 5 are checked first.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ._log import (
    DEPTH,
    MOST_PARTS,
    ArrayPart,
    Log,
    log_of_arrays,
    parts_of,
    refuse_damage,
    refuse_size,
)
from .typed_arrays import open_hdf5

#: how an HDF5 file begins, at its first byte or behind a head of so many bytes
_HDF5, _USER_BLOCK = b"\x89HDF\r\n\x1a\n", 512
_KIND = "MAT file"
_HEAD = 128
#: version 1.0 and the mark of the order of bytes, at the end of the head
_ORDERS = {b"\0\1IM": "<", b"\1\0MI": ">"}
_MATRIX, _COMPRESSED = 14, 15
#: types of plain numbers and of characters
_NUMBERS = frozenset({1, 2, 3, 4, 5, 6, 7, 9, 12, 13, 16, 17, 18})
_CELL, _STRUCT, _OBJECT, _SPARSE, _FUNCTION, _OPAQUE = 1, 2, 3, 5, 16, 17
_CLASSES = range(1, 18)
#: deepest nesting of structs and cells
_DEEPEST = 50


def open_matlab(path: Path, file: str) -> Log:
    """Open a MAT file of any version."""
    from scipy.io import loadmat, whosmat

    with path.open("rb") as stream:
        head = stream.read(_USER_BLOCK + len(_HDF5))
    if head.startswith(_HDF5) or head[_USER_BLOCK:] == _HDF5:  # with the head of MATLAB 7.3
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
    columns: dict[str, tuple[str, ArrayPart]] = {}
    arrays: dict[str, Any] = {}
    units: dict[str, str] = {}
    for name, shape, kind in listed:
        if kind == "struct":
            fields = _fields(name, content[name], 0, units)
            arrays |= fields
            for field, values in fields.items():
                columns |= parts_of(field, np.shape(values))
        elif kind not in ("opaque", "object", "function", "cell"):
            columns |= parts_of(name, shape)

    def load(names: Sequence[str]) -> Mapping[str, Any]:
        plain = [name for name in names if name not in arrays]
        with refuse_damage(_KIND, file):
            return arrays | (loadmat(path, variable_names=plain) if plain else {})

    return log_of_arrays(columns, load, file, units=units, objects=objects)


def _fields(name: str, value: Any, depth: int, units: dict[str, str]) -> dict[str, Any]:
    """Numeric fields of a struct, "log.q", including those of nested structs.

    units: gets the unit of each field for which the struct states one
    """
    array = np.asarray(value)
    if array.dtype.names and (signals := _signals(name, array, units)):
        return signals
    if array.dtype.names and array.size == 1 and depth < DEPTH:
        contents: dict[str, Any] = {}
        for field in array.dtype.names:
            contents |= _fields(f"{name}.{field}", array.reshape(-1)[0][field], depth + 1, units)
        return contents
    if array.dtype.names and 1 < array.size <= MOST_PARTS and depth < DEPTH:
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


def check_elements(path: Path) -> None:
    """Raise a ValueError for an element of an unknown kind, or one that exceeds its container.

    A file that is not of version 5 passes: other code reads it.
    """
    content = memoryview(path.read_bytes())
    order = _ORDERS.get(bytes(content[_HEAD - 4 : _HEAD]))
    if order is None:
        return
    for kind, inner in _elements(content[_HEAD:], order):
        if kind == _COMPRESSED:
            for inside, matrix in _elements(memoryview(zlib.decompress(inner)), order):
                if inside == _MATRIX:
                    _check_matrix(matrix, order, 0)
        elif kind == _MATRIX:
            _check_matrix(inner, order, 0)


def _elements(data: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Type and content of each element in turn."""
    at = 0
    while at + 8 <= len(data):
        first, size = struct.unpack_from(f"{order}II", data, at)
        begin, kind = at + 8, first
        if first >> 16:  # a small one: size and type share a word, the content is the other
            begin, kind, size = at + 4, first & 0xFFFF, first >> 16
        end = begin + size
        if end > len(data) or first >> 16 and size > 4:
            raise ValueError(f"an element of {size} bytes ends behind what holds it")
        yield kind, data[begin:end]
        at = max(end, at + 8)
        if kind != _COMPRESSED:
            at += -at % 8


def _check_matrix(data: memoryview, order: str, depth: int) -> None:
    if not data:
        return
    if depth > _DEEPEST:
        raise ValueError("structs nested too deeply")
    parts = [(kind, bytes(inner[:8]), inner) for kind, inner in _elements(data, order)]
    if not parts or len(parts[0][1]) < 8:
        raise ValueError("a matrix without its class")
    held = struct.unpack(f"{order}I", parts[0][1][:4])[0] & 0xFF
    if held not in _CLASSES:
        raise ValueError(f"a matrix of class {held}")
    if held == _OPAQUE:
        return
    if len(parts) < 3 or parts[1][0] not in (5, 6) or len(parts[1][2]) % 4:
        raise ValueError("a matrix without its size")
    sizes = struct.unpack(f"{order}{len(parts[1][2]) // 4}i", parts[1][2])
    if min(sizes, default=0) < 0:
        raise ValueError(f"a matrix of size {sizes}")
    rest = parts[3:]
    if held not in (_CELL, _STRUCT, _OBJECT, _FUNCTION):
        if not all(kind in _NUMBERS for kind, _, _ in rest):
            raise ValueError("numbers of no known type")
        return
    count = math.prod(sizes)
    if held in (_STRUCT, _OBJECT):
        rest = rest[1:] if held == _OBJECT else rest
        longest = struct.unpack(f"{order}i", rest[0][1])[0] if len(rest) > 1 else 0
        if longest <= 0 or len(rest[1][2]) % longest:
            raise ValueError("a struct without names")
        count *= len(rest[1][2]) // longest
        rest = rest[2:]
    if held != _FUNCTION and len(rest) != count or any(kind != _MATRIX for kind, _, _ in rest):
        raise ValueError(f"found {len(rest)} parts of a struct or cell, expected {count}")
    for _, _, inner in rest:
        _check_matrix(inner, order, depth + 1)

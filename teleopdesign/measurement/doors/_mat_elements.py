"""Checks of the elements of a MAT file of version 5 before scipy reads them.

scipy does not check the class of a matrix and the type of its numbers; a damaged file ends the
process with a segmentation fault, which cannot be caught.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

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

"""Results are compared by value and printed in a few lines, also with arrays or NaN in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any


class ByValue:
    """Base of frozen dataclasses (with eq=False): `is_same` compares fields, arrays print short.

    A class that defines `__repr__` keeps its definition.
    """

    def __init_subclass__(cls) -> None:
        # a dataclass writes a `__repr__` with every number of an array where the class has none
        if cls.__repr__ is object.__repr__:
            cls.__repr__ = _repr_by_fields  # type: ignore[method-assign]

    def __eq__(self, other: object) -> bool:
        return is_same(self, other) if type(self) is type(other) else NotImplemented

    def __hash__(self) -> int:
        # of fields that are names and counts: arrays and NaN have no hash that equality keeps
        plain = (getattr(self, f.name) for f in fields(self))  # type: ignore[arg-type]
        return hash((type(self), *(v for v in plain if isinstance(v, str | int))))


def _repr_by_fields(self: Any) -> str:
    shown = (f"{f.name}={_shorten(getattr(self, f.name))}" for f in fields(self) if f.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _shorten(value: Any) -> str:
    """The `repr` of a value, with shape and range in place of an array's numbers."""
    if type(value) in (list, tuple) and any(hasattr(v, "dtype") for v in value):
        return f"[{', '.join(map(_shorten, value))}]"
    if not hasattr(value, "dtype") or hasattr(value, "identical") or not value.shape:
        return repr(value)
    entries = " x ".join(map(str, value.shape))
    if value.dtype.kind not in "if" or not value.size:
        return f"<{entries} entries>"
    low, high = (float(end) for end in (value.min(), value.max()))
    return f"<{entries} numbers, {low:.4g} to {high:.4g}>"


def is_same(one: Any, other: Any) -> bool:
    """Whether two objects have the same content; NaN equals NaN, arrays are compared by entry.

    Dataclasses are compared field by field, whatever their `==` says.
    """
    if one is other:
        return True
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        if hasattr(one, "identical"):  # a Dataset of xarray
            return bool(hasattr(other, "identical") and one.identical(other))
        return one.keys() == other.keys() and all(is_same(v, other[k]) for k, v in one.items())
    if type(one) is not type(other):
        return bool(one == other) if _is_plain(one) and _is_plain(other) else False
    if is_dataclass(one) and not isinstance(one, type):
        pairs = ((getattr(one, f.name), getattr(other, f.name)) for f in fields(one) if f.compare)
        return all(is_same(a, b) for a, b in pairs)
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(is_same, one, other))
    if hasattr(one, "identical"):  # a DataArray of xarray
        return bool(one.identical(other))
    if hasattr(one, "dtype") and hasattr(one, "shape"):
        return _are_same_arrays(one, other)
    if isinstance(one, float):
        return one == other or (one != one and other != other)
    return bool(one == other)


def _is_plain(value: Any) -> bool:
    return isinstance(value, bool | int | float | complex | str) or value is None


def _are_same_arrays(one: Any, other: Any) -> bool:
    import numpy as np

    if one.shape != other.shape or one.dtype != other.dtype:
        return False
    if one.dtype.kind in "fc":
        return bool(np.array_equal(one, other, equal_nan=True))
    if one.dtype.kind == "O":
        return all(map(is_same, one.ravel().tolist(), other.ravel().tolist()))
    return bool(np.array_equal(one, other))

"""Values that never change: read-only mappings, catalogues, results with parts by name.

They pickle, copy, compare by value and print in a few lines, also with arrays or NaN in them.
"""

from __future__ import annotations

from collections.abc import ItemsView, Iterable, Iterator, KeysView, Mapping, ValuesView
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

from .errors import ModelError, did_you_mean

Key = TypeVar("Key")
Content = TypeVar("Content", covariant=True)
Default = TypeVar("Default")

_MOST_SHOWN = 400  # characters of a mapping's content that its repr shows


class Frozen(Mapping[Key, Content]):
    """A read-only copy of a mapping; it equals any mapping with the same content."""

    __slots__ = ("__weakref__", "_content")
    _content: dict[Key, Content]

    def __init__(self, content: Mapping[Key, Content] | None = None) -> None:
        object.__setattr__(self, "_content", dict(content or {}))

    def __getitem__(self, key: Key) -> Content:
        return self._content[key]

    def __iter__(self) -> Iterator[Key]:
        return iter(self._content)

    def __len__(self) -> int:
        return len(self._content)

    def __contains__(self, key: object) -> bool:
        return key in self._content

    def keys(self) -> KeysView[Key]:
        """The keys, in the order of the original mapping."""
        return self._content.keys()

    def items(self) -> ItemsView[Key, Content]:
        """The pairs of key and value, in the order of the original mapping."""
        return self._content.items()

    def values(self) -> ValuesView[Content]:
        """The values, in the order of the original mapping."""
        return self._content.values()

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Frozen):
            return self._content == other._content
        return self._content == dict(other) if isinstance(other, Mapping) else NotImplemented

    def __hash__(self) -> int:
        return hash(frozenset(self._content.items()))

    def __or__(self, other: Mapping[Any, Any]) -> dict[Any, Any]:
        return {**self._content, **other}

    def __ror__(self, other: Mapping[Any, Any]) -> dict[Any, Any]:
        return {**other, **self._content}

    def __setattr__(self, name: str, value: object) -> None:
        raise TypeError(f"a {type(self).__name__} cannot be changed")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._content,)

    def __repr__(self) -> str:
        text = repr(self._content)
        if len(text) <= _MOST_SHOWN:
            return text
        return f"{{{', '.join(map(str, self._content))}}}"


class UnknownName(ModelError, KeyError):
    """A catalogue has no entry of that name; also a KeyError, as for any mapping."""

    def __str__(self) -> str:
        return str(self.args[0])


class Catalogue(Frozen[str, Content]):
    """A read-only mapping from names to objects of one kind, such as effects.

    A name that the catalogue lacks raises ModelError with the nearest name.

    kind: word for one object in messages ("effect")
    see: last words of that message, which say where to look
    """

    __slots__ = ("kind", "see")
    kind: str
    see: str

    def __init__(self, content: Mapping[str, Content], kind: str, see: str = "") -> None:
        super().__init__(content)
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "see", see)

    def __getitem__(self, key: str) -> Content:
        value: Any = self.get(key, self)
        if value is self:
            near = did_you_mean(key, self) if isinstance(key, str) else ""
            name = f'"{key}"' if isinstance(key, str) else repr(key)
            end = f"{near}{self.see}" if self.see else f", has {', '.join(self)}{near}"
            raise UnknownName(f"{self.kind}s: no {self.kind} {name}{end}")
        return value  # type: ignore[no-any-return]

    def get(self, key: object, default: Any = None) -> Any:
        """The object of that name, or the default."""
        try:
            return self._content.get(key, default)  # type: ignore[call-overload]
        except TypeError:  # a list or the like is no name
            return default

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._content, self.kind, self.see)

    def __repr__(self) -> str:
        return f"{self.kind}s: {', '.join(self)}"


class ByName:
    """A result with parts by name: `name in result` and `for name in result`, as for a dict.

    Without both, Python asks `result[0]`, `result[1]` ... instead, and gets an error about "0".
    """

    def _names(self) -> Iterable[str]:
        """The names that `result[name]` takes."""
        raise NotImplementedError

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __contains__(self, name: object) -> bool:
        return name in tuple(self._names())


class ByValue:
    """Base of frozen dataclasses (with eq=False): `is_same` compares fields, arrays print short.

    A class that defines `__repr__` keeps its definition.
    """

    def __init_subclass__(cls) -> None:
        # a dataclass writes a `__repr__` with every number of an array where the class has none
        if cls.__repr__ is object.__repr__:
            cls.__repr__ = repr_by_fields  # type: ignore[method-assign]

    def __eq__(self, other: object) -> bool:
        return is_same(self, other) if type(self) is type(other) else NotImplemented

    def __hash__(self) -> int:
        # of fields that are names and counts: arrays and NaN have no hash that equality keeps
        plain = (getattr(self, f.name) for f in fields(self))  # type: ignore[arg-type]
        return hash((type(self), *(v for v in plain if isinstance(v, str | int))))


def repr_by_fields(self: Any) -> str:
    """A dataclass by its fields, with shape and range in place of an array's numbers."""
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

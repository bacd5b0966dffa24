"""Read-only mappings, which pickle, copy and compare by value; catalogues are among them."""

from __future__ import annotations

from collections.abc import ItemsView, Iterator, KeysView, Mapping, ValuesView
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

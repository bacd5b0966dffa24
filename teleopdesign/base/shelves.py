"""A folder as a catalogue: each file that does not begin with `_` holds one object of one kind.

A file is imported when its object is asked for by name, so that listing the names loads nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

from .frozen import Catalogue
from .recipes import remember

Content = TypeVar("Content", covariant=True)


class _Files(Mapping[str, Any]):
    """The objects of a folder's files by name, each read at its first use."""

    def __init__(
        self, folder: str, path: Path, read: Callable[[ModuleType], Any], defined_in: str
    ) -> None:
        files = (p for p in path.glob("*.py") if not p.name.startswith("_"))
        self._names = tuple(sorted(p.stem for p in files))
        self._folder, self._read, self._defined_in = folder, read, defined_in
        self._there: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._there:
            if name not in self._names:
                raise KeyError(name)
            module = import_module(f"{self._folder}.{name}")
            recipe = self._folder, self._defined_in, name
            self._there[name] = remember(self._read(module), _from_shelf, *recipe)
        return self._there[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class Shelf(Catalogue[Content]):
    """A catalogue of the files of a folder; it and its objects pickle by their names."""

    __slots__ = ("_defined_in", "_folder")
    _folder: str
    _defined_in: str

    def __init__(
        self,
        folder: str,
        path: Path,
        read: Callable[[ModuleType], Any],
        kind: str,
        see: str = "",
        *,
        defined_in: str = "",
    ) -> None:
        """A shelf of a folder.

        folder: its name as a package;  path: where it lies
        read: the object that a module of the folder defines
        defined_in: module whose import makes the shelf; "": the folder itself
        """
        super().__init__({}, kind, see)
        object.__setattr__(self, "_folder", folder)
        object.__setattr__(self, "_defined_in", defined_in or folder)
        object.__setattr__(self, "_content", _Files(folder, path, read, defined_in or folder))
        _SHELVES[folder] = self

    def __reduce__(self) -> tuple[Any, ...]:
        return _shelf, (self._folder, self._defined_in)


_SHELVES: dict[str, Shelf[Any]] = {}


def _shelf(folder: str, defined_in: str) -> Shelf[Any]:
    import_module(defined_in)
    return _SHELVES[folder]


def _from_shelf(folder: str, defined_in: str, name: str) -> Any:
    return _shelf(folder, defined_in)[name]

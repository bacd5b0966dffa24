"""Folders of the package: their faces, their catalogues, and their calls.

    if TYPE_CHECKING:
        from .margins import loop_margins as loop_margins

    __getattr__, __dir__, __all__ = lazy_face(__name__)

Face: the imports for type checkers are the only list of a folder's public names; each is imported
at its first use. So `import` of one module of the folder loads no other.

Shelf: a folder as a catalogue. Each file that does not begin with `_` holds one object of one kind,
and is imported when its object is asked for by name.

Call: `td.diagnose(experiment)` is `td.find_missing(experiment)`. `td.NAME` is a folder once a
module in the folder is imported, so that no function can have the name of a folder. A folder named
by a verb runs the one function that a user expects. A folder named by a noun raises an error that
lists its functions.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

from .arguments import checked_in_place, type_imports
from .frozen import Catalogue
from .recipes import remember


def lazy_face(folder: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """`__getattr__`, `__dir__` and `__all__` of a folder, by its imports for type checkers.

    folder: `__name__` of the folder, whose source is being run
    A public function checks the types of its arguments from its first use on (`check_types`).
    """
    homes = face_names(folder)

    def find(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {folder!r} has no attribute {name!r}")
        module, local = homes[name]
        value = checked_in_place(getattr(import_module(module), local))
        setattr(sys.modules[folder], name, value)
        return value

    return find, lambda: sorted({*homes, *vars(sys.modules[folder])}), sorted(homes)


def face_names(folder: str) -> dict[str, tuple[str, str]]:
    """Public name -> (module, its name there): a folder's imports of the package, for checkers."""
    package = f"{folder.partition('.')[0]}."
    return {n: home for n, home in type_imports(folder).items() if home[0].startswith(package)}


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


#: folder named by a verb -> the public function that runs when the folder is called
VERBS = {
    "check": "check_experiment",
    "derive": "derive_transfers",
    "design": "design_compensation",
    "diagnose": "find_missing",
    "simulate": "simulate_diagram",
}
#: folder -> what to type instead, if no single function stands for the folder
INSTEAD = {
    "app": "type `teleopdesign app` in a terminal",
    "realise": "write td.to_iosystem(diagram)",
    "show": "every result draws itself: diagnosis.plot(), study.plot; td.show.save_figure writes",
    "studies": "write td.study(diagram, axes, measures=...)",
    "tuning": "write td.tune(diagram, parameters, objective)",
    "unexplained": "write td.describe(model, experiment)",
    "next_experiment": "write td.propose_experiment(diagnosis)",
}


class _Imported(ModuleType):
    """A module that pickles as its name, so that a script's function that uses it can be sent."""

    def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
        return import_module, (self.__name__,)


class _Folder(_Imported):
    """A folder whose call runs its function; the function is looked up at the time of the call.

    A public name of the folder stands for its function, also where a module has the same name.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if type(value) is ModuleType and name in getattr(self, "__all__", ()):
            return
        super().__setattr__(name, value)

    @property
    def __call__(self) -> Any:
        package, _, folder = self.__name__.rpartition(".")
        if folder in VERBS:
            return getattr(import_module(package), VERBS[folder])
        known = ", ".join(f"td.{folder}.{n}" for n in getattr(self, "__all__", ())[:4])
        hint = INSTEAD.get(folder) or f"its functions: {known}, ..."
        raise TypeError(f"td.{folder} is a folder and not callable; {hint}")


class _Package(_Imported):
    """The package; a folder that the import system binds as its attribute becomes a `_Folder`."""

    def __setattr__(self, name: str, value: Any) -> None:
        if type(value) is ModuleType and value.__name__ == f"{self.__name__}.{name}":
            if hasattr(value, "__path__"):
                value.__class__ = _Folder
                for public in getattr(value, "__all__", ()):
                    if type(vars(value).get(public)) is ModuleType:
                        delattr(value, public)
        super().__setattr__(name, value)


def let_folders_be_called(package: str) -> None:
    """From now on the folders of the package can be called, however they are imported.

    package: name of the package, whose module is already imported
    """
    sys.modules[package].__class__ = _Package

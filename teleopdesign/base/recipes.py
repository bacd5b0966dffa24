"""Objects that hold code: effects and control laws, from the package or a user's file.

Code cannot be pickled. An object from a catalogue is looked up by its name, an object from a file
is read again, and a derived object is derived again: `remember` keeps the recipe of each.

Of a user's file the bytes that were read are the code that runs; the digest that identifies a file
in answers and pickles is the digest of these bytes. Nothing is written beside the file.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Container, Iterator, Mapping, MutableMapping
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

from .errors import ModelError, TeleopDesignError, did_you_mean

Thing = TypeVar("Thing")

_RECIPES: WeakKeyDictionary[Any, tuple[Callable[..., Any], tuple[Any, ...]]] = WeakKeyDictionary()


def remember(thing: Thing, make: Callable[..., Thing], *arguments: Any) -> Thing:
    """The thing itself; from now on it pickles as `make(*arguments)`.

    make: a function at the top level of a module of the package
    """
    _RECIPES[thing] = (make, arguments)
    return thing


def maker_of(thing: Any) -> Callable[..., Any] | None:
    """The function that made the thing, where its recipe is known."""
    return _RECIPES[thing][0] if thing in _RECIPES else None


def recipe(thing: Any) -> tuple[Any, ...]:
    """The return value of `__reduce__` for a frozen dataclass that holds functions.

    raises ModelError: the object has no recipe, and it holds a function that cannot be imported
    """
    if thing in _RECIPES:
        return _RECIPES[thing]
    if nameless := _nameless(thing):
        raise ModelError(
            f'{type(thing).__name__} "{thing.name}": cannot be written to a file or sent to '
            f"another process: {nameless} is a function without a name that can be imported; write "
            "it into a file of its own, or define it at the top of a module"
        )
    return _remake, (type(thing), {f.name: getattr(thing, f.name) for f in fields(thing)})


def _remake(kind: type[Any], values: Mapping[str, Any]) -> Any:
    return kind(**values)


def _nameless(thing: Any, place: str = "") -> str:
    """Place of the first function in `thing` that cannot be imported by its name, or ""."""
    if is_dataclass(thing) and not isinstance(thing, type):
        parts: list[tuple[str, Any]] = [(f.name, getattr(thing, f.name)) for f in fields(thing)]
    elif isinstance(thing, Mapping):
        parts = [(str(k), v) for k, v in thing.items()]
    elif callable(thing) and not isinstance(thing, type) and hasattr(thing, "__qualname__"):
        home: Any = sys.modules.get(getattr(thing, "__module__", None) or "")
        for part in thing.__qualname__.split("."):
            home = getattr(home, part, None)
        return "" if home is thing else place
    else:
        return ""
    inner = (_nameless(v, f"{place}.{n}" if place else n) for n, v in parts)
    return next((name for name in inner if name), "")


#: a function that makes the object again: (resolved path, path as the user wrote it, digest that
#: the file must have)
Again = Callable[[Path, Path, str], Thing]


def checked_path(path: str | Path, what: str, example: str) -> Path:
    """The path of a user's file, after a check of its existence and name.

    what: content of the file, for messages;  example: a valid file name, for messages
    raises ModelError: there is no such file, its name is not an identifier, or it is no Python file
    """
    path = Path(path)
    if not path.is_file():
        raise ModelError(f"{path}: no such {what} file")
    if path.suffix != ".py":
        raise ModelError(f"{path}: found a file of kind {path.suffix!r}, expected .py")
    if not path.stem.isidentifier():
        raise ModelError(f'{path}: the file name "{path.stem}" must be a name such as {example}')
    return path


def load_once(
    loaded: MutableMapping[tuple[Path, str], Thing],
    again: Again[Thing],
    read: Callable[[bytes], Thing],
    path: Path,
    written: Path,
    expected: str,
) -> Thing:
    """The object that a user's file defines; the same object again if the file has not changed.

    loaded: objects by path and digest; changed in place
    again: the function as whose call the object pickles
    read: makes the object from the bytes of the file
    path, written: the resolved path, and the path as the user wrote it
    expected: digest that the file must have; "" for any

    raises ModelError: the file cannot be read, or its digest is not the expected one
    """
    try:
        content = path.read_bytes()
    except OSError as problem:
        raise ModelError(f"{written}: cannot be read: {problem.strerror or problem}") from None
    digest = hashlib.sha256(content).hexdigest()
    if expected and digest != expected:
        raise ModelError(f"{written}: the file has changed since it was used")
    thing = loaded.get((path, digest))
    if thing is None:
        thing = loaded[path, digest] = remember(read(content), again, path, written, digest)
    return thing


def run(content: bytes, path: Path, package: str) -> ModuleType:
    """The module that the bytes of a user's file define; its relative imports start at `package`.

    raises ModelError: it cannot be compiled or run (the message names the kind of error)
    """
    module = ModuleType(f"{package}.{path.stem}")
    module.__file__ = str(path)
    module.__package__ = package
    try:
        exec(compile(content, str(path), "exec"), module.__dict__)
    except TeleopDesignError as error:
        raise ModelError(f"{path}: {error}") from error
    except (Exception, SystemExit) as error:  # any failure of a user's file is reported: its kind
        raise ModelError(f"{path}: {type(error).__name__}: {error}") from error
    return module


@contextmanager
def laws_of(path: Path, parameters: Container[str]) -> Iterator[None]:
    """Turn any failure of a user's law into a ModelError that names the file.

    parameters: names of the parameters `p`;  the other signals are those of `now`
    """
    try:
        yield
    except TeleopDesignError:
        raise
    except (AttributeError, TypeError, ValueError) as error:  # SympifyError is a ValueError
        raise ModelError(f"{path}: law: {_explain(error, parameters)}") from error
    except (Exception, SystemExit) as error:  # a law is the user's Python too
        raise ModelError(f"{path}: law: {type(error).__name__}: {error}") from error


def _explain(error: Exception, parameters: Container[str]) -> str:
    """The text of an error in a law; a misspelt signal or parameter is told by its name."""
    if not isinstance(error, AttributeError) or not isinstance(error.obj, SimpleNamespace):
        return str(error)
    known = vars(error.obj)
    holder = "p" if all(name in parameters for name in known) else "now"
    return f'{holder} has no "{error.name}"{did_you_mean(error.name or "", known)}'

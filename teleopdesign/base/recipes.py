"""How objects that hold code are made again; pickles and copies of effects and laws use this.

Code cannot be pickled. An object from a catalogue is looked up by its name, an object from a file
is read again, and a derived object is derived again: `remember` keeps the recipe of each.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

from .errors import ModelError

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

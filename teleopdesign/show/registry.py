"""Which function shows which result, and how.

    @shows("text")
    def margin_map_text(margins: MarginMap) -> str: ...

    @shows("figure")
    def plot_margin_map(margins: MarginMap) -> Figure: ...

The first argument names the class. The functions for the classes of a folder stand in the file of
`show` with the name of this folder, or in the files of a folder with that name. No other file is
imported when a result asks for a look. So a text does not load the library of figures.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, TypeVar

from ..base.shown import LookKind
from .figures.style import in_house_style

Look = TypeVar("Look", bound=Callable[..., Any])

#: kinds of looks that are figures
FIGURES = ("figure", "nyquist", "curves", "map", "panels", "scatter", "sensitivity")
#: (kind of look, name of a class) -> its function
LOOKS: dict[tuple[LookKind, str], Callable[..., Any]] = {}


def shows(kind: LookKind) -> Callable[[Look], Look]:
    """The function below gives this kind of look of the class that its first argument names.

    A figure is drawn in house style.
    raises ValueError: another function gives the same look
    """

    def enter(look: Look) -> Look:
        shown = str(next(iter(look.__annotations__.values())))
        if (kind, shown) in LOOKS:
            raise ValueError(f"show: two functions give the {kind} of {shown}")
        entered = in_house_style(look) if kind in FIGURES else look
        LOOKS[kind, shown] = entered
        return entered

    return enter


def look_of(kind: LookKind, shown: type) -> Callable[..., Any] | None:
    """The function for a kind of look of a class; None: there is none."""
    _load(shown.__module__.split(".")[1])
    return LOOKS.get((kind, shown.__name__))


@cache
def _load(folder: str) -> None:
    """Import the looks of the classes of a folder of the package."""
    name = f"{__name__.rpartition('.')[0]}.{folder}"
    module = import_module(name)
    for part in iter_modules(getattr(module, "__path__", ())):
        import_module(f"{name}.{part.name}")

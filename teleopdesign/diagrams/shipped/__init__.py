"""Diagrams that ship with the package: one file is one diagram, named by the file.

Each has a docstring, whose first line says what it is, and a function `diagram()` that makes it.
Commands know it by the file's name with dashes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from pkgutil import iter_modules

from ...base.frozen import Catalogue
from ..wiring import Diagram


def _list_builders() -> Mapping[str, Callable[[], Diagram]]:
    files = sorted(m.name for m in iter_modules(__path__) if not m.name.startswith("_"))
    makers = {n: import_module(f"{__name__}.{n}").diagram for n in files}
    return Catalogue({n.replace("_", "-"): maker for n, maker in makers.items()}, "diagram")


#: name -> what makes the diagram
SHIPPED: Mapping[str, Callable[[], Diagram]] = _list_builders()


def load_shipped(name: str) -> Diagram:
    """A diagram that ships with the package, by its name.

    raises ModelError: no such diagram; the message names the nearest one
    """
    return SHIPPED[name]()

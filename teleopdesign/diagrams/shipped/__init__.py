"""Diagrams that ship with the package: one file is one diagram, named by the file.

Each has a docstring, whose first line says what it is, and a function `diagram()` that makes it.
Commands know it by the file's name with dashes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING

from ...base.frozen import Catalogue

if TYPE_CHECKING:
    from ..wiring import Diagram


def _wire(file: str) -> Diagram:
    made: Diagram = import_module(f"{__name__}.{file}").diagram()
    return made


_FILES = sorted(m.name for m in iter_modules(__path__) if not m.name.startswith("_"))
#: name -> what makes the diagram
SHIPPED: Mapping[str, Callable[[], Diagram]] = Catalogue(
    {file.replace("_", "-"): partial(_wire, file) for file in _FILES}, "diagram"
)


def load_shipped(name: str) -> Diagram:
    """A diagram that ships with the package, by its name.

    raises ModelError: no such diagram; the message names the nearest one
    """
    return SHIPPED[name]()

"""The face of a folder: its public names, each imported at its first use.

    if TYPE_CHECKING:
        from .margins import loop_margins as loop_margins

    __getattr__, __dir__, __all__ = lazy_face(__name__)

The imports for type checkers are the only list of the names. So a folder loads a module when one of
its names is used, and `import` of one module of the folder loads no other.
"""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import resolve_name
from types import FunctionType
from typing import Any

from .arguments import check_types


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
        value = getattr(import_module(module), local)
        if isinstance(value, FunctionType) and not hasattr(value, "_is_checked"):
            value = check_types(value)
            # also where it is defined: a function pickles as what its module has under its name
            setattr(sys.modules[value.__module__], value.__name__, value)
        setattr(sys.modules[folder], name, value)
        return value

    return find, lambda: sorted({*homes, *vars(sys.modules[folder])}), sorted(homes)


@cache
def face_names(folder: str) -> dict[str, tuple[str, str]]:
    """Public name -> (module, its name there), of the imports of a folder for type checkers."""
    homes = dict[str, tuple[str, str]]()
    tree = ast.parse(inspect.getsource(sys.modules[folder]))
    for node in (n for block in tree.body if isinstance(block, ast.If) for n in block.body):
        if isinstance(node, ast.ImportFrom) and node.level:
            home = resolve_name("." * node.level + (node.module or ""), folder)
            homes |= {a.asname or a.name: (home, a.name) for a in node.names}
    return homes

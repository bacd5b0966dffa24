"""What the code of a user consists of: bytecode, names, contents of classes, imported files.

Compiled code counts in place of its source. It is also there at a prompt, it is what runs even if
the file was changed after its import, and comments make no difference.
"""

from __future__ import annotations

import dis
import sys
import types
from collections.abc import Iterator
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path, PurePath
from typing import Any

#: entries of a class that Python adds, or that hold for every class
_OF_EVERY_CLASS = frozenset(
    (
        "__dict__",
        "__weakref__",
        "__doc__",
        "__module__",
        "__qualname__",
        "__firstlineno__",
        "__static_attributes__",
        "__abstractmethods__",
        "_abc_impl",
        "__dataclass_params__",
        "__dataclass_fields__",
    )
)

#: folders of installed packages
_INSTALLED = frozenset(("site-packages", "dist-packages"))


def parts_of_code(code: types.CodeType) -> tuple[Any, ...]:
    """All of a function's code that decides what it computes; no lines and no file."""
    return (
        code.co_code,
        code.co_names,
        code.co_varnames,
        code.co_freevars,
        code.co_argcount,
        code.co_posonlyargcount,
        code.co_kwonlyargcount,
        code.co_flags,
        code.co_consts,
    )


def names_in(code: types.CodeType) -> set[str]:
    """Names that a function uses, including those of functions within it."""
    return set(code.co_names).union(*map(names_in, _inner(code)))


def _inner(code: types.CodeType) -> list[types.CodeType]:
    return [c for c in code.co_consts if isinstance(c, types.CodeType)]


def contents_of_class(kind: type) -> dict[str, Any]:
    """Methods and values of a class by name, without its bases."""
    return {n: v for n, v in sorted(vars(kind).items()) if n not in _OF_EVERY_CLASS}


def imported_files(code: types.CodeType) -> Iterator[str]:
    """Name and digest of the files that a function imports when it is called."""
    for step in dis.get_instructions(code):
        if step.opname == "IMPORT_NAME" and not is_installed(step.argval):
            try:
                file = Path(find_spec(step.argval).origin)  # type: ignore[union-attr, arg-type]
                if _INSTALLED & {*file.parts}:
                    continue
                digest = sha256(file.read_bytes()).hexdigest()
            except (ImportError, ValueError, AttributeError, TypeError, OSError):
                continue  # built in, in a folder without __init__, or not there
            yield f"{step.argval} {digest}"
    for inner in _inner(code):
        yield from imported_files(inner)


def is_installed(module: str | None) -> bool:
    """Whether a module is of this package, of the standard library, or of an installed one."""
    top = (module or "").partition(".")[0]
    if top == __package__.partition(".")[0] or top in sys.stdlib_module_names:
        return top != "__main__"
    file = getattr(sys.modules.get(module or ""), "__file__", "") or ""
    return bool(_INSTALLED & {*PurePath(file).parts})

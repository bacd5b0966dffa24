"""Fingerprint of a study: one text, equal for equal model, axes and measures.

Numbers and texts count by value. A function counts by its source, together with all names of the
same module, or of the enclosing function, that it uses: a changed constant above the function makes
another study. Functions of installed packages count by name; the versions are stored separately.
"""

from __future__ import annotations

import hashlib
import inspect
import sys
import types
from collections.abc import Iterator, Mapping, Set
from dataclasses import fields, is_dataclass
from pathlib import PurePath
from typing import Any

import numpy as np

_DIGITS = 16  # hexadecimal digits of the hash: 64 bits


def fingerprint(*things: Any) -> str:
    """The same text for the same content, in any process and on any machine."""
    whole = hashlib.sha256()
    for part in _parts(things, set()):
        whole.update(part.encode("utf-8", "surrogatepass"))
        whole.update(b"\0")
    return whole.hexdigest()[:_DIGITS]


def _parts(thing: Any, above: set[int]) -> Iterator[str]:
    if thing is None or isinstance(thing, bool | int | str | bytes | PurePath):
        yield f"{type(thing).__name__} {thing!s}"
    elif isinstance(thing, float | complex):
        yield repr(thing)
    elif isinstance(thing, np.generic):
        yield from _parts(thing.item(), above)
    elif isinstance(thing, np.ndarray):
        if thing.dtype == object:
            yield from _parts(thing.tolist(), above)
        else:
            data = hashlib.sha256(np.ascontiguousarray(thing).tobytes()).hexdigest()
            yield f"array {thing.dtype.str} {thing.shape} {data}"
    elif id(thing) in above:
        yield "as before"
    else:
        # what is being described is kept alive by the caller: its id stays unique
        yield from _parts_of_object(thing, above | {id(thing)})


def _parts_of_object(thing: Any, above: set[int]) -> Iterator[str]:
    if isinstance(thing, Mapping):
        yield f"mapping {len(thing)}"
        for key, value in thing.items():
            yield from _parts(key, above)
            yield from _parts(value, above)
    elif isinstance(thing, list | tuple):
        yield f"{len(thing)} of"
        for value in thing:
            yield from _parts(value, above)
    elif isinstance(thing, Set):
        yield from sorted(" ".join(_parts(v, above)) for v in thing)
    elif isinstance(thing, types.FunctionType):
        yield from _parts_of_function(thing, above)
    elif isinstance(thing, types.MethodType):
        yield from _parts((thing.__func__, thing.__self__), above)
    elif isinstance(thing, type | types.BuiltinFunctionType | types.ModuleType):
        yield f"{getattr(thing, '__module__', '')}.{getattr(thing, '__qualname__', thing)}"
    elif is_dataclass(thing):
        yield type(thing).__qualname__
        for one in fields(thing):
            yield one.name
            yield from _parts(getattr(thing, one.name), above)
    elif hasattr(thing, "free_symbols"):  # of sympy
        from sympy import srepr

        yield srepr(thing)
    else:
        yield f"{type(thing).__module__}.{type(thing).__qualname__}"
        attributes = getattr(thing, "__dict__", None)
        # a generator of random numbers that a distribution carries is no part of it
        kept = {k: v for k, v in (attributes or {}).items() if "random_state" not in k}
        if kept:
            yield from _parts(kept, above)
        elif " at 0x" not in (text := repr(thing)):
            yield text


def _parts_of_function(function: types.FunctionType, above: set[int]) -> Iterator[str]:
    name = f"function {function.__qualname__}"
    yield name
    if _is_installed(function.__module__):
        yield function.__module__
        return
    try:
        yield inspect.getsource(function)
    except (OSError, TypeError):  # written at a prompt: the code itself
        yield function.__code__.co_code.hex()
        yield from _parts([c for c in function.__code__.co_consts if _is_plain(c)], above)
    yield from _parts(function.__defaults__ or (), above)
    yield from _parts(function.__kwdefaults__ or {}, above)
    for cell in function.__closure__ or ():
        try:
            yield from _parts(cell.cell_contents, above)
        except ValueError:  # a name that has no value yet
            continue
    for used in sorted(_names(function.__code__)):
        if used in function.__globals__:
            yield used
            yield from _parts(function.__globals__[used], above)


def _names(code: types.CodeType) -> set[str]:
    """Names that a function uses, including those of functions within it."""
    inner = (c for c in code.co_consts if isinstance(c, types.CodeType))
    return set(code.co_names).union(*(_names(c) for c in inner))


def _is_plain(thing: Any) -> bool:
    return isinstance(thing, str | int | float | bool | tuple | None)


def _is_installed(module: str | None) -> bool:
    """Whether a module is of this package, of the standard library, or of an installed one."""
    top = (module or "").partition(".")[0]
    if top == __package__.partition(".")[0] or top in sys.stdlib_module_names:
        return top != "__main__"
    file = getattr(sys.modules.get(module or ""), "__file__", "") or ""
    return "site-packages" in PurePath(file).parts

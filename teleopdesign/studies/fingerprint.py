"""Fingerprint of a study: one text, equal for equal model, axes and measures.

Numbers and texts count by value. A function counts by its compiled code, together with all names of
its module, or of the enclosing function, that it uses: a changed constant above the function makes
another study. So does a changed method of a class, and a changed function of a module of the user.
Functions and classes of installed packages count by name; the versions are stored separately.

Compiled code counts in place of the source. It is also there at a prompt, it is what runs even if
the file was changed after its import, and comments make no difference.
"""

from __future__ import annotations

import dis
import hashlib
import platform
import sys
import types
from collections.abc import Iterator, Mapping, Set
from dataclasses import fields, is_dataclass
from functools import cached_property, partial
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path, PurePath
from typing import Any

import numpy as np

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


_DIGITS = 16  # hexadecimal digits of the hash: 64 bits


def fingerprint(*things: Any) -> str:
    """The same text for the same content, in any process and on any machine."""
    whole = hashlib.sha256()
    for part in _Description().parts(things, frozenset()):
        whole.update(part.encode("utf-8", "surrogatepass"))
        whole.update(b"\0")
    return whole.hexdigest()[:_DIGITS]


class _Description:
    """Parts of the text that is hashed; a function or class that is used twice is described once.

    `above` holds the ids of what is being described: their caller keeps them alive, so that ids
    stay unique.
    """

    def __init__(self) -> None:
        self._numbers: dict[int, int] = {}

    def parts(self, thing: Any, above: frozenset[int]) -> Iterator[str]:
        if thing is None or isinstance(thing, bool | int | str | bytes | PurePath):
            yield f"{type(thing).__name__} {thing!s}"
        elif isinstance(thing, float | complex):
            yield repr(thing)
        elif isinstance(thing, np.generic):
            yield from self.parts(thing.item(), above)
        elif isinstance(thing, np.ndarray):
            if thing.dtype == object:
                yield from self.parts(thing.tolist(), above)
            else:
                data = hashlib.sha256(np.ascontiguousarray(thing).tobytes()).hexdigest()
                yield f"array {thing.dtype.str} {thing.shape} {data}"
        elif id(thing) in above:
            yield "as before"
        elif isinstance(thing, types.FunctionType | type):
            yield from self._once(thing, above | {id(thing)})
        else:
            yield from self._object(thing, above | {id(thing)})

    def _once(self, thing: Any, above: frozenset[int]) -> Iterator[str]:
        yield f"{type(thing).__name__} {thing.__qualname__}"
        if is_installed(thing.__module__):
            yield str(thing.__module__)
        elif id(thing) in self._numbers:
            yield f"number {self._numbers[id(thing)]}"
        else:
            self._numbers[id(thing)] = len(self._numbers)
            inner = self._class if isinstance(thing, type) else self._function
            yield from inner(thing, above)

    def _object(self, thing: Any, above: frozenset[int]) -> Iterator[str]:
        if isinstance(thing, Mapping):
            yield f"mapping {len(thing)}"
            for key, value in thing.items():
                yield from self.parts(key, above)
                yield from self.parts(value, above)
        elif isinstance(thing, list | tuple):
            yield f"{len(thing)} of"
            for value in thing:
                yield from self.parts(value, above)
        elif isinstance(thing, Set):
            yield from sorted(" ".join(self.parts(v, above)) for v in thing)
        elif isinstance(thing, types.CodeType):
            yield from self.parts(parts_of_code(thing), above)
        elif isinstance(thing, types.MethodType):
            yield from self.parts((thing.__func__, thing.__self__), above)
        elif isinstance(thing, partial):
            yield from self.parts(("partial", thing.func, thing.args, thing.keywords), above)
        elif isinstance(thing, staticmethod | classmethod):
            yield from self.parts((type(thing).__name__, thing.__func__), above)
        elif isinstance(thing, property):
            yield from self.parts((thing.fget, thing.fset), above)
        elif isinstance(thing, types.BuiltinFunctionType | types.ModuleType):
            yield f"{getattr(thing, '__module__', '')}.{getattr(thing, '__qualname__', thing)}"
        elif is_dataclass(thing):
            yield from self.parts(type(thing), above)
            for one in fields(thing):
                yield one.name
                yield from self.parts(getattr(thing, one.name), above)
        elif hasattr(thing, "free_symbols"):  # of sympy
            from sympy import srepr

            yield srepr(thing)
        elif isinstance(compiled := getattr(thing, "py_func", None), types.FunctionType):
            yield from self.parts((compiled, getattr(thing, "targetoptions", None)), above)
        else:
            yield from self._instance(thing, above)

    def _instance(self, thing: Any, above: frozenset[int]) -> Iterator[str]:
        """Describe any other object: its class, and its attributes or else its pickled state."""
        kind = type(thing)
        yield f"{kind.__module__}.{kind.__qualname__}"
        yield from self.parts(kind, above)
        listed = (c.__dict__.get("__slots__", ()) for c in kind.__mro__)
        slots = (s for one in listed for s in ((one,) if isinstance(one, str) else one))
        state = {s: getattr(thing, s) for s in slots if s[:2] != "__" and hasattr(thing, s)}
        attributes = getattr(thing, "__dict__", None)
        state |= attributes if isinstance(attributes, dict) else {}
        kept = {
            # a generator of random numbers that a distribution carries is no part of it
            k: v
            for k, v in state.items()
            if "random_state" not in k and not isinstance(getattr(kind, k, None), cached_property)
        }
        if kept:
            yield from self.parts(kept, above)
            return
        try:
            made = thing.__reduce_ex__(4)
        except Exception:  # not made to be stored: pickling may raise anything
            made = ""
        # what lists hold beside their state is an iterator, which can be read once
        state_of = (
            made if isinstance(made, str) else (*made[1:3], *map(list, filter(None, made[3:5])))
        )
        yield from self.parts(state_of, above)
        if not state_of and " at 0x" not in (text := repr(thing)):
            yield text

    def _function(self, function: types.FunctionType, above: frozenset[int]) -> Iterator[str]:
        yield from self.parts(function.__code__, above)
        yield from self.parts(function.__defaults__ or (), above)
        yield from self.parts(function.__kwdefaults__ or {}, above)
        yield from self.parts(vars(function), above)
        for cell in function.__closure__ or ():
            try:
                yield from self.parts(cell.cell_contents, above)
            except ValueError:  # a name that has no value yet
                continue
        names = names_in(function.__code__)
        yield from self._names(function.__globals__, names, above)
        yield from imported_files(function.__code__)

    def _names(
        self, known: Mapping[str, Any], names: Set[str], above: frozenset[int]
    ) -> Iterator[str]:
        """Describe the values of those names that are known; of modules, what is used of them."""
        for name in sorted(names & known.keys()):
            value = known[name]
            yield name
            yield from self.parts(value, above)
            if isinstance(value, types.ModuleType) and id(value) not in above:
                if not is_installed(value.__name__):
                    yield from self._names(vars(value), names, above | {id(value)})

    def _class(self, kind: type, above: frozenset[int]) -> Iterator[str]:
        yield from self.parts(kind.__bases__, above)
        contents = {n: v for n, v in sorted(vars(kind).items()) if n not in _OF_EVERY_CLASS}
        yield from self.parts(contents, above)


_COUNTED = ("teleopdesign", "numpy", "scipy", "sympy", "numba", "xarray")


def versions() -> dict[str, str]:
    """Package -> version; "" for a package that is used without an installation; also Python."""
    by_name = {"python": platform.python_version()}
    for name in _COUNTED:
        try:
            by_name[name] = version(name)
        except PackageNotFoundError:
            by_name[name] = ""
    return by_name

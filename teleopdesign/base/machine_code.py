"""Machine code that numba keeps on disk; where that is impossible, the process compiles again.

A function is compiled in the process, which takes seconds, where nothing can be written (a package
that only other users may write to, no home folder, a full disk) or where the kept code is damaged.
None of these raises an error.

Compiled code contains the functions that it calls. numba asks only whether the file of the function
itself has changed, so that after an upgrade the code of an old callee would still run within its
caller. Here the files of all callees count.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def compile_and_keep(function: Function) -> Function:
    """The compiled function, which releases Python's lock; its machine code is kept on disk."""
    dispatcher: Any
    try:
        dispatcher = njit(cache=True, nogil=True)(function)
    except RuntimeError:  # numba finds no place for machine code
        dispatcher = njit(nogil=True)(function)
    _stamp_callees(dispatcher)
    without_cache_errors(dispatcher)
    return cast(Function, dispatcher)


def _stamp_callees(dispatcher: Any) -> None:
    """Treat kept machine code as out of date if a file of a called function has changed."""
    file: Any = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if hasattr(file, "_source_stamp"):
        file._source_stamp = (file._source_stamp, hash_files(list_files_of_callees(dispatcher)))


def list_files_of_callees(dispatcher: Any) -> list[Path]:
    """Files of all compiled functions that a compiled function calls, directly or indirectly."""
    waiting, callees = [dispatcher.py_func], set[Any]()
    while waiting:
        function = waiting.pop()
        for name in function.__code__.co_names:
            called = getattr(function.__globals__.get(name), "py_func", None)
            if called is not None and called not in callees:
                callees.add(called)
                waiting.append(called)
    return sorted({Path(called.__code__.co_filename) for called in callees})


def hash_files(files: Iterable[Path]) -> str:
    """A hash of the contents of files; a file that cannot be read counts as empty."""
    whole = hashlib.sha256()
    for path in files:
        with suppress(OSError):
            whole.update(path.read_bytes())
    return whole.hexdigest()[:20]


def without_cache_errors(dispatcher: object) -> None:
    """Let a compiled function run although its cache cannot be read or written.

    An object that is not a compiled function with a cache stays unchanged.
    """
    cache = getattr(dispatcher, "_cache", None)
    if hasattr(cache, "load_overload") and hasattr(cache, "save_overload"):
        dispatcher._cache = _ForgivingCache(cache)  # type: ignore[attr-defined]


class _ForgivingCache:
    """numba's cache of one function; a failure to read or write it raises no error.

    After a failure to read, the function is compiled. numba unpickles the code, and a truncated
    file may raise any exception.
    """

    def __init__(self, cache: Any) -> None:
        self._cache = cache

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return self._cache.load_overload(sig, target_context)
        except Exception:
            self._drop()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            self._cache.save_overload(sig, data)
        except Exception:
            self._drop()

    def _drop(self) -> None:
        try:
            self._cache.flush()
        except Exception:
            self._cache.disable()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._cache, name)

"""What the package takes of its machine: cores, copies of the process, compiled code.

A copy (fork) has all that this process read, prepared and compiled, but none of its threads but the
one that made it, and would wait for ever for a lock that another thread held. So only a process
without other threads is copied, and only on Linux. A copy ends with this process, even where that
one is killed. It never receives Ctrl-C, runs none of the handlers with which this process reacts to
signals or ends, and makes no copies itself.

Libraries start threads by themselves. These would compete with other processes, and could add
numbers in another order: `one_thread` allows none.

numba keeps machine code on disk. A function is compiled in the process, which takes seconds, where
nothing can be written (a package that only other users may write to, no home folder, a full disk)
or where the kept code is damaged. None of these raises an error. Compiled code contains the
functions that it calls, while numba asks only whether the file of the function itself has changed:
here the files of all callees count.
"""

from __future__ import annotations

import ctypes
import hashlib
import multiprocessing
import os
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeVar, cast


def count_cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):  # not on macOS, nor on Windows
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def count_workers() -> int:
    """Threads or copies of this process at a time: as many as cores, or NUMBA_NUM_THREADS."""
    allowed = os.environ.get("NUMBA_NUM_THREADS", "")
    return int(allowed) if allowed.isdecimal() and int(allowed) else count_cores()


#: environment in which libraries start no threads
ONE_THREAD = {
    name: "1"
    for name in (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "NUMBA_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    )
}


@contextmanager
def one_thread() -> Iterator[None]:
    """Allow no threads of libraries, and none that simulate side by side."""
    from threadpoolctl import threadpool_limits

    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    try:
        with threadpool_limits(1):
            yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


_makes_copies = sys.platform == "linux"


def can_copy() -> bool:
    """Whether a copy of this process can work: only its own thread would be copied."""
    is_alone = threading.active_count() == 1 and multiprocessing.parent_process() is None
    return _makes_copies and is_alone


def forbid_copies() -> None:
    """Let this process make no copies from now on."""
    global _makes_copies
    _makes_copies = False


@contextmanager
def shield_from_ctrl_c() -> Iterator[None]:
    """Start processes that never receive Ctrl-C, not even before their first line of Python.

    Ctrl-C goes to all processes of a terminal; the calling process alone decides what happens. It
    receives its Ctrl-C afterwards.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Copy:
    """A copy of this process that runs, or has ended."""

    def __init__(self, work: Callable[[], None]) -> None:
        """Copy this process; the copy does its work, and ends.

        To be called within `shield_from_ctrl_c`. raises OSError: no memory for another process
        """
        first = os.getpid()
        for stream in (sys.stdout, sys.stderr):  # a copy would write once more what waits there
            with suppress(AttributeError, OSError, ValueError):
                stream.flush()
        self._number = _fork()
        self._status: int | None = None
        if self._number == 0:
            _work_and_end(work, first)

    def wait(self) -> int:
        """Wait for its end; returns its exit status, or minus the signal that ended it."""
        if self._status is None:
            try:
                self._status = os.waitstatus_to_exitcode(os.waitpid(self._number, 0)[1])
            except ChildProcessError:  # the caller's program has waited for it
                self._status = 0
        return self._status

    def kill(self) -> None:
        """End it at once."""
        if self._status is None:
            with suppress(ProcessLookupError):
                os.kill(self._number, signal.SIGKILL)


def _fork() -> int:
    """Copy the process; 0 in the copy."""
    with warnings.catch_warnings():
        # Python 3.12 counts threads of linear algebra, which end before a copy and begin anew
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()


def _work_and_end(work: Callable[[], None], first: int) -> None:
    """Work in this copy, and end it without a second end of all that the first process will end."""
    status = 1
    try:
        act_as_copy(first)
        work()
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 1
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(status)


def act_as_copy(first: int) -> None:
    """Let this copy of the process `first` end with it, and take no part in what that one handles.

    It ends even where the first process is killed, ignores Ctrl-C, and makes no copies.
    """
    _end_with(first)
    forbid_copies()
    _forget_handlers()


def _end_with(first: int) -> None:
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # 1: PR_SET_PDEATHSIG of Linux
    if os.getppid() != first:
        os._exit(0)


def _forget_handlers() -> None:
    """Ignore Ctrl-C; other signals do what they do without the first process's handlers."""
    signal.set_wakeup_fd(-1)
    for number in signal.valid_signals():
        if callable(signal.getsignal(number)):
            signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)


Function = TypeVar("Function", bound=Callable[..., Any])


def compile_and_keep(function: Function) -> Function:
    """The compiled function, which releases Python's lock; its machine code is kept on disk."""
    from numba import njit  # its import takes as long as that of the whole package

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

"""The independent parts of a diagnosis on all cores, each core with a copy of this process.

Threads would wait for Python's lock: with two of them, short records took up to half as long again
as with one. A copy of the process (a fork) has everything that was read and prepared, so that only
results travel. A copy has no threads of libraries, so where this process has other threads, or is
a worker of a study, and on systems other than Linux, the parts are computed one after another. The
results are the same.

Linear algebra uses one thread: its threads wait for each other in busy loops.

Freed memory stays with the process for the next array. By default, glibc returns blocks of 128 KiB
and more to the system at once, until a larger block was freed. Then the system clears each array of
a residual page by page: a sixth of the processor time.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import pickle
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import lru_cache, partial
from multiprocessing.connection import Connection, wait
from typing import Any, TypeVar

import numpy as np
from threadpoolctl import ThreadpoolController

from ..base.machine import Copy, can_copy, count_workers, shield_from_ctrl_c

T = TypeVar("T")
#: most copies, and most threads, at a time
MOST = 8


def map_on_cores(
    function: Callable[[Any], T],
    parts: Sequence[Any],
    *,
    begun: Callable[[int], None] = lambda _: None,
    before: Callable[[], None] = lambda: None,
) -> list[T]:
    """Results of a function in the order of its parts, computed in copies of this process.

    Parts begin in their order, on each core the next one when another is done. A part that a copy
    could not finish is computed here, so that this process raises its error.

    begun: called in this process with the index of each part that begins
    before: called once if copies are made: what each copy would otherwise do again
    """
    keep_freed_memory()
    results: dict[int, T] = {}
    with one_thread_of_algebra():
        copies = min(MOST, count_workers(), len(parts))
        if copies > 1 and can_copy():
            before()
            results = _computed_by_copies(function, parts, copies, begun)
        for i, part in enumerate(parts):
            if i not in results:
                begun(i)
                results[i] = function(part)
    return [results[i] for i in range(len(parts))]


def map_in_threads(function: Callable[..., T], *arguments: Iterable[Any]) -> list[T]:
    """Results of a function in the order of the arguments, as of `map`, computed in threads.

    For work in compiled loops, which release Python's lock.
    """
    keep_freed_memory()
    workers = min(MOST, count_workers())
    with one_thread_of_algebra(), ThreadPoolExecutor(workers) as pool:
        return list(pool.map(function, *arguments))


def _computed_by_copies(
    function: Callable[[Any], T],
    parts: Sequence[Any],
    copies: int,
    begun: Callable[[int], None],
) -> dict[int, T]:
    """Index of a part -> its result, without parts that no copy finished."""
    waiting, added = os.pipe()
    # a few bytes for each part: they fit into the pipe, from which each copy reads the next number
    os.write(added, np.arange(len(parts)).tobytes())
    os.close(added)
    gc.freeze()  # else a collection in a copy would write to, and so copy, all memory
    running: dict[Connection, Copy] = {}
    try:
        with suppress(OSError), shield_from_ctrl_c():  # no memory for another process: fewer copies
            for _ in range(copies):
                here, there = multiprocessing.Pipe(duplex=False)
                running[here] = Copy(partial(_compute, function, parts, waiting, there))
                there.close()
        return _collect(list(running), begun)
    finally:
        gc.unfreeze()
        os.close(waiting)
        for connection, copy in running.items():
            connection.close()
            copy.kill()
            copy.wait()


def _compute(
    function: Callable[[Any], object], parts: Sequence[Any], waiting: int, results: Connection
) -> None:
    """Compute one part after another in this copy, which makes no copies and ends here."""
    global MOST
    MOST = 1
    with suppress(BaseException):  # the first process computes this part, and raises its error
        while number := os.read(waiting, np.arange(1).nbytes):
            (i,) = np.frombuffer(number, dtype=int).tolist()
            results.send((i, None))
            results.send((i, pickle.dumps(function(parts[i]), pickle.HIGHEST_PROTOCOL)))


def _collect(running: list[Connection], begun: Callable[[int], None]) -> dict[int, Any]:
    """What the copies computed, until all have ended."""
    results = dict[int, Any]()
    while running:
        for connection in wait(running):
            assert isinstance(connection, Connection)
            try:
                i, content = connection.recv()
            except (EOFError, OSError):  # it has ended, perhaps within a message
                running.remove(connection)
                continue
            if content is None:
                begun(i)
            else:
                results[i] = pickle.loads(content)
    return results


@contextmanager
def one_thread_of_algebra() -> Iterator[None]:
    """Libraries of linear algebra with one thread, meanwhile."""
    with _find_libraries().limit(limits=1, user_api="blas"):
        yield


@lru_cache(maxsize=1)
def _find_libraries() -> ThreadpoolController:
    """The loaded libraries of linear algebra; the search takes 6 ms, so it is made once."""
    import scipy.linalg  # noqa: F401  it has a library of its own, which must be loaded by now

    return ThreadpoolController()


@lru_cache(maxsize=1)
def keep_freed_memory() -> None:
    """Make the process keep freed memory, by freeing one large block that was never written.

    After that, glibc keeps blocks up to this size, and twice as many bytes in all. Other allocators
    are not affected.
    """
    # the largest size that glibc adapts to, 32 MiB with the header; with less, glibc would clear
    # arrays of long records again and again
    np.empty(32 * 2**20 - 2**14, dtype=np.uint8)

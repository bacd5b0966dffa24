"""Threads and memory of a diagnosis: work shared among the cores.

Linear algebra keeps to one core meanwhile. Its threads wait for each other by spinning: with
several callers on two cores that took a third of the time.

Memory that is freed stays with the process for the next array. glibc gives blocks from 128 KiB on
back to the system at once until a larger one was freed, so that each array of a residual was
cleared by the system page by page: a sixth of the processor time.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from threadpoolctl import ThreadpoolController

T = TypeVar("T")
#: most threads at a time
MOST = 4


def map_in_threads(function: Callable[..., T], *arguments: Iterable[Any]) -> list[T]:
    """Results of a function, called as by `map`, in the order of the arguments."""
    keep_freed_memory()
    workers = min(MOST, os.cpu_count() or 1)
    with _find_libraries().limit(limits=1, user_api="blas"), ThreadPoolExecutor(workers) as pool:
        return list(pool.map(function, *arguments))


@lru_cache(maxsize=1)
def _find_libraries() -> ThreadpoolController:
    """The libraries of linear algebra, all loaded by now: to look for them takes 6 ms each time."""
    return ThreadpoolController()


@lru_cache(maxsize=1)
def keep_freed_memory() -> None:
    """Let the process keep freed memory, by glibc's own rule: free a large block, untouched.

    Once it is freed, glibc keeps blocks up to its size, and twice as many bytes in all. Of no
    effect where the system's allocator is another one.
    """
    # the largest that counts, 32 MiB with its head; less: arrays of long records are cleared anew
    np.empty(32 * 2**20 - 2**14, dtype=np.uint8)

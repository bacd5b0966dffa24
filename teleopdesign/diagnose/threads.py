"""Threads and memory of a diagnosis: work shared among the cores.

Meanwhile linear algebra uses one thread only. Its threads wait for each other in busy loops: with
several callers on two cores this took a third of the time.

Freed memory stays with the process for the next array. By default, glibc returns blocks of 128 KiB
and more to the system at once, until a larger block was freed. Then the system clears each array of
a residual page by page: a sixth of the processor time.
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
    """Results of a function in the order of the arguments, as of `map`, computed in threads."""
    keep_freed_memory()
    workers = min(MOST, os.cpu_count() or 1)
    with _find_libraries().limit(limits=1, user_api="blas"), ThreadPoolExecutor(workers) as pool:
        return list(pool.map(function, *arguments))


@lru_cache(maxsize=1)
def _find_libraries() -> ThreadpoolController:
    """The loaded libraries of linear algebra; the search takes 6 ms, so it is made once."""
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

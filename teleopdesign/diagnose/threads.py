"""Work shared among the cores: kernels and transforms release the interpreter's lock.

Linear algebra keeps to one core meanwhile. Its threads wait for each other by spinning: with
several callers on two cores that took a third of the time.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits

T = TypeVar("T")
#: most threads at a time
MOST = 4


def map_in_threads(function: Callable[..., T], *arguments: Iterable[Any]) -> list[T]:
    """Results of a function, called as by `map`, in the order of the arguments."""
    workers = min(MOST, os.cpu_count() or 1)
    with threadpool_limits(limits=1, user_api="blas"), ThreadPoolExecutor(workers) as pool:
        return list(pool.map(function, *arguments))

"""Work shared among the cores: kernels and transforms release the interpreter's lock."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

T = TypeVar("T")
#: most threads at a time
MOST = 4


def in_threads(function: Callable[..., T], *given: Iterable[Any]) -> list[T]:
    """Results of a function, called as by `map`, in the order of what is given."""
    with ThreadPoolExecutor(max_workers=min(MOST, os.cpu_count() or 1)) as pool:
        return list(pool.map(function, *given))

"""How many cores a process may use, and how many threads or copies it may have at a time."""

from __future__ import annotations

import os


def count_cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):  # not on macOS, nor on Windows
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def count_workers() -> int:
    """Threads or copies of this process at a time: as many as cores, or NUMBA_NUM_THREADS."""
    allowed = os.environ.get("NUMBA_NUM_THREADS", "")
    return int(allowed) if allowed.isdecimal() and int(allowed) else count_cores()

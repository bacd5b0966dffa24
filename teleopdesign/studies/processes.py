"""Points of a study on all cores of this machine, computed in worker processes.

Each point is computed by the same code with the same numbers in any process; the number of
processes changes only the time.
"""

from __future__ import annotations

import time
from collections.abc import Iterable

from ..base.machine import can_copy, count_cores, one_thread
from .evaluate import StudyTask, Unit, evaluate_unit
from .pool import Pool, Sink

#: s: processor time that a process needs before its first point: started anew, or as a copy
_START_TIME, _COPY_TIME = 2.5, 0.1
#: part of this time, in which this process alone computes: an estimate for the whole study
_TRIAL = 0.4
#: points that are computed to measure their time: so many that what each block needs beside its
#: points, 10 ms, counts little; from units of `_MANY` points, of which they are an eighth at most
_MEASURED, _MANY = 64, 512


def run_here(
    task: StudyTask, units: Iterable[Unit], sink: Sink, *, until: float = float("inf")
) -> int:
    """Evaluate points in this process, for about `until` s; returns the number of units done."""
    start, count = time.monotonic(), 0
    with one_thread():
        for unit in units:
            for outcome in evaluate_unit(task, unit):
                sink(outcome)
            count += 1
            if time.monotonic() - start > until:
                break
    return count


def run_on_this_machine(
    task: StudyTask, units: list[Unit], sink: Sink, workers: int | None
) -> None:
    """Evaluate points in one process per core, or in this process if that is as fast.

    workers: number of processes; None: chosen by the time of the first points
    """
    count, is_compiled, seconds = workers or count_cores(), True, float("inf")
    # points side by side call no function of the user, which could end this process
    is_safe = workers is None or can_copy() and len(units[0]) > 1
    if count == 1 or is_safe and len(units) == 1:
        run_here(task, units, sink)
        return
    if is_safe and can_copy() and len(units[0]) >= _MANY:
        seconds = _compile_and_measure(task, units[0]) * sum(map(len, units))
    elif is_safe:
        # the first unit alone compiles what the others have or find in the cache
        units = units[run_here(task, units[:1], sink) :]
    else:
        is_compiled = False
    if workers is None and seconds == float("inf"):
        units, seconds = _run_on_trial(task, units, sink)
    saved = float("inf") if workers else seconds * (1 - 1 / count)
    if not _run_in_processes(task, units, sink, count, saved=saved, is_compiled=is_compiled):
        run_here(task, units, sink)


def _run_in_processes(
    task: StudyTask,
    units: list[Unit],
    sink: Sink,
    workers: int,
    *,
    saved: float,
    is_compiled: bool,
) -> bool:
    """Evaluate points in processes beside this one; returns whether that pays.

    saved: s of computing that this process then need not do
    is_compiled: whether this process has computed such points, and so compiled the code for them
    """
    if not units or saved < _start_time():
        return False
    workers = min(workers, len(units))
    pool = Pool(task, units, sink, is_compiled=is_compiled)
    try:
        pool.start_copies(workers)
        if not pool.workers and saved < _START_TIME:
            return False
        pool.run(workers)
    finally:
        pool.close()
    return True


def _start_time() -> float:
    return _COPY_TIME if can_copy() else _START_TIME


def _compile_and_measure(task: StudyTask, unit: Unit) -> float:
    """Compile the code of points side by side; returns the time of a point, s. Nothing is kept."""
    from ..realise.side_by_side import LANES

    with one_thread():
        evaluate_unit(task, unit[:LANES])
        start = time.monotonic()
        evaluate_unit(task, unit[:_MEASURED])
    return (time.monotonic() - start) / _MEASURED


def _run_on_trial(task: StudyTask, units: list[Unit], sink: Sink) -> tuple[list[Unit], float]:
    """Evaluate some units here; returns the others, and the time that they would take here, s."""
    start = time.monotonic()
    done = run_here(task, units, sink, until=_TRIAL * _start_time())
    return units[done:], (time.monotonic() - start) / max(done, 1) * len(units[done:])

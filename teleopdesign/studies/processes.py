"""Points of a study in processes beside this one: of this machine, or of an existing Dask cluster.

Each is an executor as of `concurrent.futures`. A point is computed by the same code with the same
numbers in any process; the number of processes changes only the time.
"""

from __future__ import annotations

import gc
import os
import pickle
import signal
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache, partial
from typing import Any

from ..base.errors import ExperimentError, ModelError, TeleopDesignError
from ..base.machine import ONE_THREAD, count_cores, forbid_copies, one_thread, shield_from_ctrl_c
from .evaluate import StudyTask, Unit, evaluate_unit
from .fingerprint import versions
from .outcomes import as_row
from .shared_units import SharedUnits, Sink, UnitResult, Workers

#: s: processor time that a process needs before its first point
_START_TIME = 2.5
#: s: for which this process computes alone, to estimate the time of the whole study
_TRIAL = 1.0
#: points that are computed to measure their time, so many that what each block needs beside its
#: points, 10 ms, counts little; from units of `_MANY` points, of which they are an eighth at most
_MEASURED, _MANY = 64, 512
#: s between two looks of a worker whether the process that asked is still there
_BETWEEN_LOOKS = 1.0
#: s: duration of a task of a cluster, long against the milliseconds of the scheduler for each
_TASK_TIME = 1.0
#: tasks for each thread that a cluster has at a time: enough to be busy, and few enough to stop
#: soon
_AHEAD = 3


def run_on_this_machine(
    task: StudyTask, units: list[Unit], sink: Sink, workers: int | None
) -> None:
    """Evaluate points in one process per core, or in this process if that is as fast.

    workers: number of processes; None: chosen by the time of the first points. Then a task that
        cannot be sent is computed in this process
    raises ModelError: a task that cannot be sent to that many processes
    """
    count, is_compiled = workers or count_cores(), True
    if len(units) == 1 and (workers is None or len(units[0]) > 1):
        count = 1
    if count > 1 and len(units[0]) >= _MANY:
        seconds = _compile_and_measure(task, units[0]) * sum(map(len, units))
    elif count > 1 and workers is None:
        # the first unit alone compiles what the others find in the cache
        units = units[_run_here(task, units[:1], sink) :]
        start = time.monotonic()
        done = _run_here(task, units, sink, until=_TRIAL)
        units, seconds = units[done:], (time.monotonic() - start) * len(units[done:]) / max(done, 1)
    else:  # a function of the user, which could end this process
        is_compiled, seconds = False, 0.0
    if workers is None and seconds * (1 - 1 / count) < _START_TIME:
        count = 1
    try:
        payload = b"" if count == 1 else pack_task(task)
    except ModelError:
        if workers is not None:
            raise
        count = 1
    if count == 1 or not units:
        _run_here(task, units, sink)
        return
    SharedUnits(units, sink, is_compiled=is_compiled).run(
        lambda: _processes(payload, min(count, len(units)))
    )


def _run_here(
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


def _compile_and_measure(task: StudyTask, unit: Unit) -> float:
    """Compile the code of points side by side; returns the time of a point, s. Nothing is kept."""
    from ..realise.side_by_side import LANES

    with one_thread():
        evaluate_unit(task, unit[:LANES])
        start = time.monotonic()
        evaluate_unit(task, unit[:_MEASURED])
    return (time.monotonic() - start) / _MEASURED


@contextmanager
def _processes(payload: bytes, count: int) -> Iterator[Workers]:
    from joblib.externals.loky import ProcessPoolExecutor

    executor = ProcessPoolExecutor(
        count, initializer=_begin, initargs=(payload, os.getpid()), env=ONE_THREAD
    )
    try:
        with shield_from_ctrl_c():
            first = executor.submit(os.getpid)
        first.result()
        yield Workers(executor, lambda: count, _evaluate_here)
    finally:
        executor.shutdown(kill_workers=True)


def pack_task(task: StudyTask) -> bytes:
    """The task as bytes for another process, with the code of functions from scripts and notebooks.

    raises ModelError: a part of the task cannot be sent
    """
    import cloudpickle

    try:
        return bytes(cloudpickle.dumps(task))
    except TeleopDesignError as error:
        raise ModelError(f"{error}; or take workers=1") from error
    except (TypeError, AttributeError, pickle.PicklingError) as error:
        raise ModelError(
            f"the model or a measure cannot be sent to another process: {error}; take "
            "workers=1, or define it at the top of a module"
        ) from error


#: in a worker: the task that it computes
_tasks: list[StudyTask] = []


def _begin(payload: bytes, first: int) -> None:
    # Ctrl-C goes to all processes of a terminal: the one that asked decides what happens
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    forbid_copies()
    threading.Thread(target=_end_with, args=(first,), daemon=True).start()
    # what a user's function prints must not come between results
    os.dup2(2, 1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    _tasks.append(pickle.loads(payload))


def _end_with(first: int) -> None:
    """End this process when the one that asked has ended, even where that one is killed."""
    while os.getppid() == first:
        time.sleep(_BETWEEN_LOOKS)
    os._exit(0)


def _evaluate_here(unit: Unit, until: float) -> UnitResult:
    result = _evaluate_in_time(_tasks[-1], unit, until)
    if not gc.get_freeze_count():  # what was imported stays: no search for unused cycles there
        gc.freeze()
    return result


def _evaluate_in_time(task: StudyTask, unit: Unit, until: float) -> UnitResult:
    """In a worker: the outcomes of a block, or of the points that it begins within `until` s."""
    start, rows = time.monotonic(), list[tuple[Any, ...]]()
    for outcome in evaluate_unit(task, unit):
        rows.append(as_row(outcome))
        if not isinstance(unit, range) and time.monotonic() - start > until:
            break
    return rows, time.monotonic() - start


def run_on_cluster(task: StudyTask, units: list[Unit], sink: Sink, address: str) -> None:
    """Evaluate points in the workers of the scheduler at an address, such as "tcp://10.0.0.1:8786".

    raises ExperimentError: no scheduler there, or no longer, no worker, dask is not installed
    raises ModelError: workers have another version of a package
    """
    SharedUnits(units, sink).run(lambda: _cluster(task, address))


@contextmanager
def _cluster(task: StudyTask, address: str) -> Iterator[Workers]:
    try:
        from distributed import Client
    except ImportError:
        raise ExperimentError(
            "study: a cluster needs dask: pip install 'teleopdesign[cluster]'"
        ) from None
    try:
        client = Client(address, timeout="5s", set_as_default=False)
    except (OSError, ValueError, TypeError) as error:  # TimeoutError is an OSError
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ExperimentError(f"study: no scheduler answers at {address}: {reason}") from None

    def count_threads() -> int:
        try:
            return max(int(sum(client.nthreads().values())), 1)
        except OSError:
            raise ExperimentError(
                f"study: the scheduler at {address} answers no more; with out=, the same call "
                "goes on where this one stopped"
            ) from None

    try:
        _check_versions(client, address)
        evaluate = partial(_evaluate_packed, pack_task(task))
        executor = client.get_executor(pure=False)
        yield Workers(executor, count_threads, evaluate, _TASK_TIME, _AHEAD, " on the cluster")
    finally:
        client.close(timeout=5)


def _check_versions(client: Any, address: str) -> None:
    by_worker = client.run(versions)
    if not by_worker:
        raise ExperimentError(f"study: the scheduler at {address} has no worker")
    here = versions()
    for worker, there in by_worker.items():
        for name, version_here in here.items():
            if there.get(name) != version_here:
                raise ModelError(
                    f"study: worker {worker} has {name} {there.get(name)}, here is "
                    f"{version_here}: results could differ"
                )


def _evaluate_packed(payload: bytes, unit: Unit, until: float) -> UnitResult:
    """In a worker: the outcomes of a unit."""
    with one_thread():
        return _evaluate_in_time(_task(payload), unit, until)


@lru_cache(maxsize=4)
def _task(payload: bytes) -> StudyTask:
    task: StudyTask = pickle.loads(payload)
    return task

"""Points of a study in processes beside this one: its copies, processes started anew, a cluster.

Each is an executor as of `concurrent.futures`. A point is computed by the same code with the same
numbers in any process; the number of processes changes only the time.

A copy has the task and all compiled code at once, where loky needs seconds to start a process anew.
No copy is made on systems other than Linux, beside other threads (a notebook) and within a worker.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import pickle
import signal
import threading
import time
import warnings
from collections.abc import Iterable, Iterator
from concurrent.futures.process import ProcessPoolExecutor
from contextlib import contextmanager
from typing import Any

from ..base.errors import ModelError, TeleopDesignError
from ..base.machine import (
    ONE_THREAD,
    Copy,
    act_as_copy,
    can_copy,
    count_cores,
    forbid_copies,
    has_hidden_threads,
    one_thread,
    shield_from_ctrl_c,
)
from .evaluate import StudyTask, Unit, evaluate_unit
from .outcomes import as_row
from .shared_units import BatchResult, SharedUnits, Sink, Workers

#: s: processor time that a process needs before its first point: started anew, or as a copy
_START_TIME, _COPY_TIME = 2.5, 0.1
#: part of this time, in which this process alone computes: an estimate for the whole study
_TRIAL = 0.4
#: s between two looks of a worker whether the process that asked is still there
_BETWEEN_LOOKS = 1.0
#: points that are computed to measure their time: so many that what each block needs beside its
#: points, 10 ms, counts little; from units of `_MANY` points, of which they are an eighth at most
_MEASURED, _MANY = 64, 512


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
        _run_here(task, units, sink)
        return
    if is_safe and can_copy() and len(units[0]) >= _MANY:
        seconds = _compile_and_measure(task, units[0]) * sum(map(len, units))
    elif is_safe:
        # the first unit alone compiles what the others have or find in the cache
        units = units[_run_here(task, units[:1], sink) :]
    else:
        is_compiled = False
    if workers is None and seconds == float("inf"):
        start = time.monotonic()
        until = _TRIAL * (_COPY_TIME if can_copy() else _START_TIME)
        done = _run_here(task, units, sink, until=until)
        seconds = (time.monotonic() - start) / max(done, 1) * len(units[done:])
        units = units[done:]
    saved = float("inf") if workers else seconds * (1 - 1 / count)
    are_copies = saved >= _COPY_TIME and _can_work_as_copy()
    if not units or saved < (_COPY_TIME if are_copies else _START_TIME):
        _run_here(task, units, sink)
        return
    start_copies = _copies if are_copies else _started_anew
    SharedUnits(units, sink, is_compiled=is_compiled).run(
        lambda is_first: (start_copies if is_first else _started_anew)(task, min(count, len(units)))
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


def _can_work_as_copy() -> bool:
    """Whether a copy of this process works: a trial shows whether it would lack any threads."""
    if not can_copy():
        return False
    try:
        with shield_from_ctrl_c(), one_thread():
            Copy(lambda: None).wait()
            return not has_hidden_threads()
    except OSError:  # no memory for another process
        return False


@contextmanager
def _copies(task: StudyTask, count: int) -> Iterator[Workers]:
    context, before = multiprocessing.get_context("fork"), {*multiprocessing.active_children()}
    executor = ProcessPoolExecutor(count, context, _begin_copy, (task, os.getpid()))
    gc.freeze()  # else a collection in a copy would write to, and so copy, all memory
    try:
        with one_thread(), shield_from_ctrl_c(), warnings.catch_warnings():
            # Python 3.12 counts threads of linear algebra, which end before a copy and begin anew
            warnings.simplefilter("ignore", DeprecationWarning)
            executor.submit(os.getpid)  # all processes start here
        yield Workers(executor, lambda: count, _evaluate_batch)
    finally:
        gc.unfreeze()
        for process in {*multiprocessing.active_children()} - before:
            process.kill()
        executor.shutdown()


@contextmanager
def _started_anew(task: StudyTask, count: int) -> Iterator[Workers]:
    from joblib.externals.loky import ProcessPoolExecutor as Loky

    executor = Loky(
        count, initializer=_begin_anew, initargs=(pack_task(task), os.getpid()), env=ONE_THREAD
    )
    try:
        with shield_from_ctrl_c():
            first = executor.submit(os.getpid)
        first.result()
        yield Workers(executor, lambda: count, _evaluate_batch)
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


def _begin_copy(task: StudyTask, first: int) -> None:
    import numpy as np

    act_as_copy(first)
    _leave_terminal()
    # numbers that a user's function draws without a seed: other ones in each process
    np.random.seed()  # noqa: NPY002
    _tasks.append(task)


def _begin_anew(payload: bytes, first: int) -> None:
    # Ctrl-C goes to all processes of a terminal: the one that asked decides what happens
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    forbid_copies()
    threading.Thread(target=_end_with, args=(first,), daemon=True).start()
    _leave_terminal()
    _tasks.append(pickle.loads(payload))


def _end_with(first: int) -> None:
    """End this process when the one that asked has ended, even where that one is killed."""
    while os.getppid() == first:
        time.sleep(_BETWEEN_LOOKS)
    os._exit(0)


def _leave_terminal() -> None:
    """What a user's function prints must not come between results."""
    os.dup2(2, 1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)


def _evaluate_batch(batch: list[Unit], until: float) -> BatchResult:
    result = evaluate_batch(_tasks[-1], batch, until)
    if not gc.get_freeze_count():  # what was imported stays: no search for unused cycles there
        gc.freeze()
    return result


def evaluate_batch(task: StudyTask, batch: list[Unit], until: float) -> BatchResult:
    """In a worker: the outcomes of the units of a batch that it begins within `until` s."""
    start, rows, done = time.monotonic(), list[tuple[Any, ...]](), 0
    while done < len(batch) and (not done or time.monotonic() - start < until):
        rows += [as_row(outcome) for outcome in evaluate_unit(task, batch[done])]
        done += 1
    return rows, time.monotonic() - start, done

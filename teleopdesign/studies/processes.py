"""Points of a study on all cores of this machine, computed in worker processes.

Each point is computed by the same code with the same numbers in any process; the number of
processes changes only the time. A process that dies is started again; a point at which that happens
twice is recorded as failed.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any, BinaryIO, cast

from ..core_count import count_cores
from ..errors import ModelError, TeleopDesignError
from .evaluate import StudyTask
from .frames import receive, send
from .outcomes import PointOutcome
from .side_by_side import Unit, evaluate_unit

Sink = Callable[[PointOutcome], None]

#: s: computing time of the points that a process receives at once; short against the intervals of
#: progress reports, long against the 0.1 ms of a message
_BATCH_TIME = 0.2
_MOST_IN_BATCH = 1000
#: s: processor time that a process needs before its first point
_START_TIME = 2.5
#: s: time of this process alone from which the time of the whole study is estimated
_TRIAL_TIME = 1.0
#: most times that a point may end the process that computes it, before the point counts as failed
_MOST_DEATHS = 2
#: threads that libraries start by themselves would compete with the other processes, and could add
#: numbers in another order
_ONE_THREAD = {
    name: "1"
    for name in (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "NUMBA_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    )
}


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


@contextmanager
def _shield_from_ctrl_c() -> Iterator[None]:
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


@contextmanager
def one_thread() -> Iterator[None]:
    """Allow no threads of libraries, and none that simulate side by side."""
    from threadpoolctl import threadpool_limits

    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(_ONE_THREAD)
    try:
        with threadpool_limits(1):
            yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


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


def run_in_processes(task: StudyTask, units: list[Unit], sink: Sink, workers: int) -> None:
    """Evaluate points in `workers` processes beside this one."""
    pool = _Pool(pack_task(task), units, sink)
    try:
        pool.run(workers)
    finally:
        pool.close()


def run_on_this_machine(
    task: StudyTask, units: list[Unit], sink: Sink, workers: int | None
) -> None:
    """Evaluate points in one process per core, or in this process if that is as fast.

    workers: number of processes; None: chosen by the time of the first points
    """
    if workers is None:
        count = count_cores()
        # the first unit alone compiles what the others find in the cache
        units = units[run_here(task, units[:1], sink) :]
        start = time.monotonic()
        done = run_here(task, units, sink, until=_TRIAL_TIME)
        each, units = (time.monotonic() - start) / max(done, 1), units[done:]
        pays = each * len(units) * (1 - 1 / count) > _START_TIME
        workers = count if pays else 1
    if not units:
        return
    if workers == 1:
        run_here(task, units, sink)
    else:
        run_in_processes(task, units, sink, min(workers, len(units)))


@dataclass
class _Worker:
    """A process with the units that it received and has not answered yet."""

    process: subprocess.Popen[bytes]
    batch: deque[Unit] = field(default_factory=deque)
    done: int = 0
    start_of_batch: float = 0.0


class _Pool:
    def __init__(self, payload: bytes, units: list[Unit], sink: Sink) -> None:
        self.payload, self.sink = payload, sink
        self.todo = deque(units)
        self.left = len(units)
        self.answers: queue.Queue[tuple[_Worker, str, Any]] = queue.Queue()
        self.workers: list[_Worker] = []
        self.deaths: dict[Unit, int] = {}
        self.each = 0.0  # s a unit, from the latest batch
        self.is_compiled = False  # whether a process has filled the cache of compiled code

    def run(self, count: int) -> None:
        """Run until every point is done.

        All processes start at once, but only one receives points until its first point is done: it
        fills the cache of compiled code for the others.
        """
        self._start(count)
        while self.left:
            worker, what, content = self.answers.get()
            if what == "outcomes":
                worker.batch.popleft()
                worker.done += 1
                self._take([PointOutcome(*row) for row in content])
                waiting, self.is_compiled = [] if self.is_compiled else self.workers, True
                for other in (w for w in waiting if not w.start_of_batch):
                    self._ask(other)
            elif what == "ready":
                if worker.done:
                    self.each = (time.monotonic() - worker.start_of_batch) / worker.done
                self._ask(worker)
            else:
                self._bury(worker)

    def _take(self, outcomes: list[PointOutcome]) -> None:
        self.left -= 1
        for outcome in outcomes:
            self.sink(outcome)

    def _start(self, count: int = 1) -> None:
        code = (
            f"import sys; sys.path[:] = {sys.path!r}; "
            "from teleopdesign.studies.worker import main; main()"
        )
        with _shield_from_ctrl_c():
            started = [
                _Worker(
                    subprocess.Popen(
                        [sys.executable, "-c", code],
                        stdin=subprocess.PIPE,
                        stdout=subprocess.PIPE,
                        env={**os.environ, **_ONE_THREAD},
                    )
                )
                for _ in range(count)
            ]
        self.workers += started
        # a long task is read only when its process has started: after the starts of all
        for worker in started:
            threading.Thread(target=self._listen, args=(worker,), daemon=True).start()
            with suppress(OSError):  # it ended at once: its listener says so
                send(cast(BinaryIO, worker.process.stdin), self.payload)
                self._ask(worker)

    def _listen(self, worker: _Worker) -> None:
        """Pass on all messages of a process until it ends."""
        pipe = cast(BinaryIO, worker.process.stdout)
        try:
            while True:
                message = receive(pipe)
                self.answers.put((worker, "ready" if message is None else "outcomes", message))
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):
            self.answers.put((worker, "died", None))

    def _ask(self, worker: _Worker) -> None:
        if not self.is_compiled and any(w.batch for w in self.workers):
            return
        fair = -(-len(self.todo) // max(len(self.workers), 1))
        size = int(_BATCH_TIME / self.each) if self.each > 0 else 1
        batch = [
            self.todo.popleft()
            for _ in range(min(max(size, 1), _MOST_IN_BATCH, max(fair, 1), len(self.todo)))
        ]
        if not batch:
            return
        worker.batch, worker.done, worker.start_of_batch = deque(batch), 0, time.monotonic()
        try:
            send(cast(BinaryIO, worker.process.stdin), batch)
        except OSError:
            return  # its listener says that it died; the batch is taken back there

    def _bury(self, worker: _Worker) -> None:
        """Take back the unanswered units of a dead process, and start another one."""
        status = worker.process.wait()
        self.workers.remove(worker)
        _close(worker.process)
        lost = worker.batch
        if not lost:
            if not self.is_compiled:
                self._start_anew(status)
            return
        first = lost.popleft()
        self.todo.extendleft(reversed(lost))
        self.deaths[first] = self.deaths.get(first, 0) + 1
        if self.deaths[first] < _MOST_DEATHS:
            self.todo.appendleft(first)
        elif len(first) == 1:
            reason = f"its process ended twice, {_describe_end(status)}"
            self._take([PointOutcome(first[0], reason=reason)])
        else:  # its points one by one
            self.todo.extendleft((index,) for index in reversed(first))
            self.left += len(first) - 1
        if self.left:
            self._start()

    def _start_anew(self, status: int) -> None:
        """Replace a process that ended before it received a point."""
        self.deaths[()] = self.deaths.get((), 0) + 1
        if self.deaths[()] == _MOST_DEATHS:
            raise ModelError(f"a process ended before its first point, {_describe_end(status)}")
        self._start()

    def close(self) -> None:
        """End every process; units without an answer are dropped."""
        for worker in self.workers:
            worker.process.kill()
        for worker in self.workers:
            worker.process.wait()
            _close(worker.process)


def _close(process: subprocess.Popen[bytes]) -> None:
    for pipe in (process.stdin, process.stdout):
        try:
            if pipe is not None:
                pipe.close()
        except OSError:  # what was left to write has no reader
            continue


def _describe_end(status: int) -> str:
    return f"by signal {-status}" if status < 0 else f"with status {status}"

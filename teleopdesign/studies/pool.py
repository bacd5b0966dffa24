"""Worker processes that share the points of a study, and what happens to points of dead processes.

A process that dies is replaced; a point at which that happens twice is recorded as failed.
"""

from __future__ import annotations

import pickle
import queue
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ..base.errors import ModelError
from ..base.machine import shield_from_ctrl_c
from .evaluate import StudyTask, Unit
from .outcomes import PointOutcome
from .worker_processes import WorkerProcess, pack_task, receive, send, start_anew, start_copies

Sink = Callable[[PointOutcome], None]

#: s: computing time of the points that a process receives at once; short against the intervals of
#: progress reports, long against the 0.1 ms of a message
_BATCH_TIME = 0.2
_MOST_IN_BATCH = 1000
#: most times that a point may end the process that computes it, before the point counts as failed
_MOST_DEATHS = 2
#: s: for a thread that listens to a process to notice its end; only a process that a user's
#: function started could keep the pipe open
_PATIENCE = 1.0


@dataclass
class _Worker:
    """A process with the units that it received and has not answered yet."""

    process: WorkerProcess
    batch: deque[Unit] = field(default_factory=deque)
    done: int = 0
    start_of_batch: float = 0.0
    is_ready: bool = False  # whether it has the task
    is_idle: bool = False
    listener: threading.Thread | None = None


class Pool:
    """Processes that compute units of a task; each outcome goes into the sink.

    is_compiled: whether the code for the units is compiled, and in the cache
    """

    def __init__(
        self, task: StudyTask, units: list[Unit], sink: Sink, *, is_compiled: bool
    ) -> None:
        self.task, self.sink, self.is_compiled = task, sink, is_compiled
        self.todo = deque(units)
        self.again = deque[Unit]()  # units that ended a process: alone, in processes started anew
        self.left = len(units)
        self.answers: queue.Queue[tuple[_Worker, str, Any]] = queue.Queue()
        self.workers: list[_Worker] = []
        self.deaths: dict[Unit, int] = {}
        self.each = 0.0  # s a unit, from the latest batch

    def start_copies(self, count: int) -> None:
        """Start copies of this process as the workers; none where it cannot be copied."""
        with shield_from_ctrl_c():
            self.workers = list(map(_Worker, start_copies(self.task, count)))

    def run(self, count: int) -> None:
        """Run until every point is done, by the copies or by processes started anew.

        All processes start at once, but unless the code is compiled, only one receives points until
        its first point is done: it fills the cache of compiled code for the others.
        """
        if self.workers:
            self._listen_to(self.workers)
        else:
            self._start_anew(count)
        while self.left:
            worker, what, content = self.answers.get()
            if what == "outcomes":
                worker.batch.popleft()
                worker.done += 1
                self._take([PointOutcome(*row) for row in content])
                if not self.is_compiled:
                    self.is_compiled = True
                    self._ask_the_idle()
            elif what == "ready":
                worker.is_ready = worker.is_idle = True
                self.deaths.pop((), None)
                if worker.done:
                    self.each = (time.monotonic() - worker.start_of_batch) / worker.done
                self._ask(worker)
            else:
                self._bury(worker)

    @cached_property
    def _payload(self) -> bytes:
        return pack_task(self.task)

    def _take(self, outcomes: list[PointOutcome]) -> None:
        self.left -= 1
        for outcome in outcomes:
            self.sink(outcome)

    def _start_anew(self, count: int = 1) -> None:
        """Start processes anew, and send them the task."""
        payload = self._payload
        with shield_from_ctrl_c():
            started = [_Worker(start_anew()) for _ in range(count)]
            self.workers += started
        # a long task is read only when its process has started: after the starts of all
        for worker in started:
            self._listen_to([worker])
            with suppress(OSError):  # it ended at once: its listener says so
                send(worker.process.questions, payload)

    def _listen_to(self, workers: list[_Worker]) -> None:
        for worker in workers:
            worker.listener = threading.Thread(target=self._listen, args=(worker,), daemon=True)
            worker.listener.start()

    def _listen(self, worker: _Worker) -> None:
        """Pass on all messages of a process until it ends."""
        try:
            while True:
                message = receive(worker.process.answers)
                self.answers.put((worker, "ready" if message is None else "outcomes", message))
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):
            self.answers.put((worker, "died", None))

    def _ask_the_idle(self) -> None:
        for worker in self.workers:
            if worker.is_idle:
                self._ask(worker)

    def _ask(self, worker: _Worker) -> None:
        if not self.is_compiled and any(w.batch for w in self.workers):
            return
        if self.again and not worker.process.is_copy:
            batch = [self.again.popleft()]
        else:
            batch = [self.todo.popleft() for _ in range(self._batch_size())]
        if not batch:
            return
        worker.batch, worker.done, worker.start_of_batch = deque(batch), 0, time.monotonic()
        worker.is_idle = False
        with suppress(OSError):  # its listener says that it died; the batch is taken back there
            send(worker.process.questions, batch)

    def _batch_size(self) -> int:
        fair = -(-len(self.todo) // max(len(self.workers), 1))
        size = int(_BATCH_TIME / self.each) if self.each > 0 else 1
        return min(max(size, 1), _MOST_IN_BATCH, max(fair, 1), len(self.todo))

    def _bury(self, worker: _Worker) -> None:
        """Take back the unanswered units of a dead process, and start another one."""
        status = worker.process.process.wait()
        self.workers.remove(worker)
        worker.process.close()
        lost = worker.batch
        if not lost:
            if not worker.is_ready:
                self._replace_early(status)
            elif self.todo:
                self._start_anew()
            return
        first = lost.popleft()
        self.todo.extendleft(reversed(lost))
        self.deaths[first] = self.deaths.get(first, 0) + 1
        if self.deaths[first] < _MOST_DEATHS:
            self.again.append(first)
        elif len(first) == 1:
            reason = f"its process ended twice, {_describe_end(status)}"
            self._take([PointOutcome(first[0], reason=reason)])
        else:  # its points one by one
            self.again.extend((index,) for index in first)
            self.left += len(first) - 1
        if self.left:
            self._start_anew()
        self._ask_the_idle()

    def _replace_early(self, status: int) -> None:
        """Replace a process that ended before it could receive a point."""
        self.deaths[()] = self.deaths.get((), 0) + 1
        if self.deaths[()] == _MOST_DEATHS:
            raise ModelError(f"a process ended before its first point, {_describe_end(status)}")
        self._start_anew()

    def close(self) -> None:
        """End every process; units without an answer are dropped."""
        for worker in self.workers:
            worker.process.process.kill()
        for worker in self.workers:
            worker.process.process.wait()
            listener = worker.listener
            if listener is not None and listener.ident is not None:
                listener.join(_PATIENCE)
            if listener is None or not listener.is_alive():  # else it would wait for the listener
                worker.process.close()


def _describe_end(status: int) -> str:
    return f"by signal {-status}" if status < 0 else f"with status {status}"

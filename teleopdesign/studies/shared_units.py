"""Units of a study among worker processes, and what happens to the units of one that ends.

The workers are an executor as of `concurrent.futures`. A process that ends breaks its executor. The
units that were under way are then computed again, in processes started anew, each with nothing
beside it. A point that ends its process once more has failed.
"""

from __future__ import annotations

import re
from collections import Counter, deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

from ..base.errors import ModelError
from .evaluate import Unit
from .outcomes import PointOutcome

Sink = Callable[[PointOutcome], None]
#: `as_row` of the outcomes of the points of a unit that were computed, and the time they took, s
UnitResult = tuple[list[tuple[Any, ...]], float]

#: s: computing time of the points that a process receives at once; short against the intervals of
#: progress reports, long against the 0.1 ms of a message
_UNIT_TIME = 0.2
_MOST_AT_ONCE = 1000
#: most times that a point may end the process that computes it, before the point counts as failed
_MOST_ENDS = 2


@dataclass(frozen=True)
class Workers:
    """Processes that evaluate units.

    count: how many there are now
    evaluate: what they call with a unit, and with the time, s, after which its other points are
        left
    unit_time: s;  ahead: units for each of them that wait or are computed
    where: place of the processes, after the name of an error
    """

    executor: Executor
    count: Callable[[], int]
    evaluate: Callable[[Unit, float], UnitResult]
    unit_time: float = _UNIT_TIME
    ahead: int = 2
    where: str = ""


class SharedUnits:
    """The units of a study among workers; each outcome goes into the sink.

    is_compiled: whether the code for the units is compiled, and in the cache; otherwise the first
        unit fills the cache with nothing beside it
    """

    def __init__(self, units: Iterable[Unit], sink: Sink, *, is_compiled: bool = True) -> None:
        self.todo, self.sink = deque(units), sink
        self.alone = deque[Unit]() if is_compiled else deque([self.todo.popleft()])
        self.pending: dict[Future[UnitResult], Unit] = {}
        self.ends: Counter[Unit] = Counter()
        self.each = 0.0  # s a point, from the latest unit
        # most points in a unit, twice as many as came back: a slow one keeps back those before it
        self.most = 1

    def run(self, start: Callable[[], AbstractContextManager[Workers]]) -> None:
        """Run until every point is done;  start: starts workers.

        raises ModelError: processes end before their first point
        """
        vain_starts = 0
        while self.todo or self.alone:
            try:
                with start() as workers:
                    vain_starts = 0
                    self._run_until_one_ends(workers)
            except BrokenExecutor as error:
                vain_starts += 1
                if vain_starts == _MOST_ENDS:
                    raise ModelError(
                        f"a process ended before its first point, {_describe_end(error)}"
                    ) from error

    def _run_until_one_ends(self, workers: Workers) -> None:
        while True:
            try:
                self._submit(workers)
            except BrokenExecutor:
                if not self.pending:
                    return
            if not self.pending:
                return
            ready, _ = wait(self.pending, return_when=FIRST_COMPLETED)
            if not all([self._take(future, workers) for future in ready]):
                for future in list(self.pending):
                    self._take(future, workers)
                return

    def _submit(self, workers: Workers) -> None:
        """Give units to the workers; a unit that goes alone waits until all others are done."""
        places = workers.ahead * workers.count()
        if self.alone:
            if not self.pending:
                self._send([self.alone[0]], workers)
                self.alone.popleft()
            return
        while self.todo and len(self.pending) < places:
            size = 1
            if not isinstance(self.todo[0], range) and self.each > 0:
                fair = -(-len(self.todo) // places)
                size = max(min(int(workers.unit_time / self.each), self.most, fair), 1)
            self._send([self.todo[k] for k in range(size)], workers)
            for _ in range(size):
                self.todo.popleft()

    def _send(self, units: list[Unit], workers: Workers) -> None:
        """Send units, of which several are single points, as one."""
        unit = units[0] if len(units) == 1 else tuple(index for one in units for index in one)
        future = workers.executor.submit(workers.evaluate, unit, workers.unit_time)
        self.pending[future] = unit

    def _take(self, future: Future[UnitResult], workers: Workers) -> bool:
        """Pass on the outcomes of a unit; returns whether its executor still works."""
        unit = self.pending.pop(future)
        try:
            rows, seconds = future.result()
        except Exception as error:
            self._put_back(unit, error, workers)
            return not isinstance(error, BrokenExecutor)
        self.each = seconds / len(rows)
        self.most = max(self.most, min(2 * len(rows), _MOST_AT_ONCE))
        self.todo.extendleft((index,) for index in reversed(unit[len(rows) :]))
        for row in rows:
            self.sink(PointOutcome(*row))
        return True

    def _put_back(self, unit: Unit, error: Exception, workers: Workers) -> None:
        """Let a unit be computed alone, as a block once more, else point by point."""
        again = isinstance(unit, range) and not self.ends[unit]
        parts: list[Unit] = [unit] if again else [(index,) for index in unit]
        self.ends.update(parts)
        for part in parts:
            if len(part) > 1 or self.ends[part] < _MOST_ENDS:
                self.alone.append(part)
                continue
            reason = f"{type(error).__name__}{workers.where}"
            if isinstance(error, BrokenExecutor):
                reason = f"its process ended twice, {_describe_end(error)}"
            self.sink(PointOutcome(part[0], reason=reason))


def _describe_end(error: BaseException) -> str:
    """How a process of loky ended, which the error's text says: EXIT(1), SIGKILL(-9)."""
    status = re.search(r"\((-?\d+)\)", str(error))
    if status is None:
        return "without a status"
    number = int(status[1])
    return f"by signal {-number}" if number < 0 else f"with status {number}"

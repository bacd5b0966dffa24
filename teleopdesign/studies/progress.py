"""Progress reports to the caller of a study while it runs."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from ..base.sentences import duration_text
from .outcomes import PointOutcome

#: s between two reports: as often as one can read
_BETWEEN = 0.5
#: number of last reports that determine the rate: 10 s
_REMEMBERED = 20


@dataclass(frozen=True)
class Progress:
    """Progress of a study.

    done, total: numbers of points;  failed: of those done;  kept: points of an earlier run
    rate: points per second;  left: s until the end at that rate, NaN: no rate is known yet
    things: what the points are, as a noun
    """

    done: int
    total: int
    failed: int
    kept: int
    rate: float
    left: float
    things: str = "points"

    def __str__(self) -> str:
        text = f"{self.done} of {self.total} {self.things}"
        if self.failed:
            text += f", {self.failed} failed"
        if self.rate > 0:
            text += f", {self.rate:.3g}/s"
        if self.left == self.left and self.done < self.total:
            text += f", {duration_text(self.left)} left"
        return text


class Clock:
    """Counts outcomes, and reports the progress to the caller from time to time."""

    def __init__(
        self,
        total: int,
        kept: int,
        tell: Callable[[Progress], object] | None,
        things: str = "points",
    ) -> None:
        self.things = things
        self.total, self.kept, self.tell = total, kept, tell
        self.done, self.failed = kept, 0
        self.last = time.monotonic()
        #: (time, points done) now and then: the rate is that of the last seconds, so that what was
        #: compiled for the first point does not count to the end
        self._recent: deque[tuple[float, int]] = deque([(self.last, kept)], maxlen=_REMEMBERED)

    def count(self, outcome: PointOutcome) -> None:
        """Count one more outcome, and report if a report is due."""
        self.done += 1
        self.failed += bool(outcome.reason)
        now = time.monotonic()
        if self.tell is not None and (now - self.last > _BETWEEN or self.done == self.total):
            self.last = now
            self._recent.append((now, self.done))
            self.tell(self.now())

    def now(self) -> Progress:
        """The present progress."""
        start, before = self._recent[0]
        passed, fresh = time.monotonic() - start, self.done - before
        rate = fresh / passed if passed > 0 else 0.0
        left = (self.total - self.done) / rate if rate > 0 else float("nan")
        return Progress(self.done, self.total, self.failed, self.kept, rate, left, self.things)

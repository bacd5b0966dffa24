"""Progress of long work: one line that changes on a terminal, elsewhere a line now and then."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from ..base.sentences import duration_text
from ._options import say

if TYPE_CHECKING:
    from ..studies import Progress

#: s between two lines of progress where no terminal shows them
BETWEEN_LINES = 10.0
#: parts of a stage that must have begun before the remaining time is shown: fewer predict too
#: little
FEWEST = 4


class Reporter:
    """Shows lines of progress on standard error.

    A line that counts the parts of its stage (`ProgressLine`) is shown with the time left in the
    stage.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._shown = clock()
        self._stage, self._start = "", clock()

    def __call__(self, text: str, *, last: bool = False) -> None:
        """Show a line;  last: it ends the work, and is printed also where no terminal shows it."""
        now = self._clock()
        line = f"{text}{self._time_left(text, now)}"
        if sys.stderr is None:
            return
        if sys.stderr.isatty():
            say(line)
        elif last or now - self._shown >= BETWEEN_LINES:
            self._shown = now
            print(line, file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Remove the line from a terminal."""
        say("")

    def _time_left(self, text: str, now: float) -> str:
        stage = getattr(text, "stage", "")
        if stage != self._stage:
            self._stage, self._start = stage, now
        begun, total = getattr(text, "begun", 0), getattr(text, "total", 0)
        if not stage or begun < FEWEST:
            return ""
        # those that were begun before this one are taken as done
        left = (now - self._start) * (total - begun + 1) / (begun - 1)
        return f", about {duration_text(left)} left of {stage}"


class PointReporter:
    """Shows the progress of a study; `last` is its latest report."""

    def __init__(self) -> None:
        self.last: Progress | None = None
        self._reporter = Reporter()

    def __call__(self, progress: Progress) -> None:
        """Show a report; the first one also shows how many points an earlier run kept."""
        if self.last is None and progress.kept:
            print(f"goes on after {progress.kept} {progress.things}", file=sys.stderr)
        self.last = progress
        self._reporter(str(progress), last=progress.done == progress.total)

    def clear(self) -> None:
        """Remove the line from a terminal."""
        self._reporter.clear()

    def describe_finished(self) -> str:
        """Words for how much is kept if the study is stopped now."""
        last = self.last
        if last is None:
            return "what is finished is"
        return f"{last.done} of {last.total} {last.things} are"

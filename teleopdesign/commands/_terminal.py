"""Output on a terminal: plain text, in characters that the terminal has, and progress of work.

A file's text may contain codes that move the cursor, clear lines or turn the direction of writing,
and a terminal may know ASCII only. All output of the commands goes through this module.
"""

from __future__ import annotations

import os
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

from ..base.errors import printable
from ..base.sentences import duration_text

if TYPE_CHECKING:
    from ..studies import Progress

#: what of control characters lays out a text
_LAYOUT = "\n\t"


class PrintableStream:
    """A text stream that escapes control characters, and characters that its encoding lacks."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """Write the text, escaped; returns its length."""
        safe = text if text.isascii() and text.isprintable() else printable(text, keep=_LAYOUT)
        encoding = getattr(self.stream, "encoding", None) or "utf-8"
        self.stream.write(safe.encode(encoding, "backslashreplace").decode(encoding))
        return len(text)

    def writelines(self, lines: Any) -> None:
        """Write each of the lines."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


@contextmanager
def printable_streams() -> Iterator[None]:
    """Inside this context, standard output and standard error escape control characters."""
    before = sys.stdout, sys.stderr
    streams = [None if s is None else PrintableStream(s) for s in before]  # None: closed
    sys.stdout, sys.stderr = streams
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


@contextmanager
def plain_warnings() -> Iterator[None]:
    """Inside this context, a warning is one line without code.

    A letter that a figure's font lacks is not reported here: the figure shows a box in its place.
    """

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        print(f"teleopdesign: warning: {message}", file=sys.stderr)

    with warnings.catch_warnings():  # puts back how warnings were shown, too
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        warnings.showwarning = show
        yield


def replace_line(text: str) -> None:
    """Write the text over the last line of a terminal; print nothing elsewhere."""
    if sys.stderr is None or not sys.stderr.isatty():
        return
    terminal = getattr(sys.stderr, "stream", sys.stderr)
    terminal.write("\r\033[K")
    print(printable(text), end="", file=sys.stderr, flush=True)


#: style -> its code (SGR) on a terminal
STYLES = {"strong": "1", "faint": "2", "good": "32", "warning": "33", "bad": "31"}


def print_styled(text: str, style_of: Callable[[str], str]) -> None:
    """Print lines, each in its style on a terminal that shows colours; elsewhere without styles.

    NO_COLOR: a user has switched colours off

    style_of: line -> a key of `STYLES`, or "" for no style
    """
    off = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    if sys.stdout is None or not sys.stdout.isatty() or off:
        print(text)
        return
    terminal = getattr(sys.stdout, "stream", sys.stdout)  # codes go past what escapes them
    for line in text.split("\n"):
        code = STYLES.get(style_of(line))
        if code is None:
            print(line)
            continue
        terminal.write(f"\033[{code}m")
        sys.stdout.write(line)
        terminal.write("\033[0m\n")


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
            replace_line(line)
        elif last or now - self._shown >= BETWEEN_LINES:
            self._shown = now
            print(line, file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Remove the line from a terminal."""
        replace_line("")

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

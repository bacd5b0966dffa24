"""Long work in the background of a page, with progress and cancellation."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from ..base.errors import TeleopDesignError

T = TypeVar("T")


class Cancelled(Exception):  # noqa: N818 - it is no error
    """Raised inside the work at its next report of progress."""


class BackgroundTask(Generic[T]):
    """One piece of work in a separate thread.

    name: of the work, for the page;  progress: its last line
    result: of the work; None until `done`, or if it failed or was cancelled
    error: one line for the user, or ""
    """

    def __init__(self, name: str, work: Callable[[Callable[[str], None]], T]) -> None:
        self.name = name
        self.progress = ""
        self.result: T | None = None
        self.error = ""
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(work,), daemon=True)
        self._thread.start()

    @property
    def done(self) -> bool:
        """Whether the work has ended, with a result or without."""
        return not self._thread.is_alive()

    def cancel(self) -> None:
        """Stop the work at its next report of progress."""
        self._stop.set()

    def wait(self, timeout: float | None = None) -> None:
        """Wait until the work has ended, or for `timeout` seconds."""
        self._thread.join(timeout)

    def _say(self, text: str) -> None:
        if self._stop.is_set():
            raise Cancelled
        self.progress = text

    def _run(self, work: Callable[[Callable[[str], None]], T]) -> None:
        try:
            result = work(self._say)
        except Cancelled:
            self.error = "cancelled"
        except (TeleopDesignError, OSError) as error:
            self.error = str(error)
        else:
            self.result = result


def stop_running(task: BackgroundTask[T] | None) -> str:
    """Cancel a task of the page; returns a note about it.

    task: None: no task runs, as at a second click; the note is then ""
    """
    if task is None:
        return ""
    task.cancel()
    return f"{task.name}: cancelled"

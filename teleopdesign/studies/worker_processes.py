"""Processes that compute points of a study: copies of this process, or processes started anew.

A copy has the task and all compiled code at once. A process that is started anew needs seconds for
that. It is used on systems other than Linux, beside other threads (a notebook), within a worker,
and in place of a copy that ended: perhaps that one could not work as a copy.
"""

from __future__ import annotations

import gc
import os
import pickle
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import BinaryIO, cast

from ..base.errors import ModelError, TeleopDesignError
from ..base.machine import Copy, can_copy, has_hidden_threads
from .evaluate import StudyTask
from .one_thread import ONE_THREAD, one_thread


@dataclass
class WorkerProcess:
    """A process, the pipe to it and the pipe from it."""

    process: Copy | subprocess.Popen[bytes]
    questions: BinaryIO
    answers: BinaryIO

    @property
    def is_copy(self) -> bool:
        """Whether it is a copy of this process, not started anew."""
        return isinstance(self.process, Copy)

    def close(self) -> None:
        """Close both pipes."""
        for pipe in (self.questions, self.answers):
            with suppress(OSError):  # what was left to write has no reader
                pipe.close()


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


def start_anew() -> WorkerProcess:
    """A new process; the first message that it expects is a packed task."""
    code = (
        f"import sys; sys.path[:] = {sys.path!r}; "
        "from teleopdesign.studies.worker import main; main()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, **ONE_THREAD},
    )
    return WorkerProcess(process, cast(BinaryIO, process.stdin), cast(BinaryIO, process.stdout))


def start_copies(task: StudyTask, count: int) -> list[WorkerProcess]:
    """Copies of this process that have the task: as many as there is memory for, or none.

    None are made of a process whose threads would be missing in a copy.
    """
    copies: list[WorkerProcess] = []
    if not can_copy():
        return copies
    gc.freeze()  # else a collection in a copy would write to, and so copy, all memory
    try:
        with one_thread(), suppress(OSError):
            while len(copies) < count:
                copies.append(_start_copy(task, copies))
                if has_hidden_threads():
                    _end(copies)
                    return []
    finally:
        gc.unfreeze()
    return copies


def _start_copy(task: StudyTask, others: Sequence[WorkerProcess]) -> WorkerProcess:
    from .worker import work_as_copy

    reading, questions = _pipe()
    answers, writing = _pipe()
    # a copy that held this end of any pipe would hide the end of this process from the others
    here = [questions, answers, *(p for o in others for p in (o.questions, o.answers))]
    with reading, writing:
        copy = Copy(partial(work_as_copy, task, reading, writing, here))
    return WorkerProcess(copy, questions, answers)


def _pipe() -> tuple[BinaryIO, BinaryIO]:
    """What is read from the first is written into the second."""
    reading, writing = os.pipe()
    return os.fdopen(reading, "rb"), os.fdopen(writing, "wb")


def _end(copies: list[WorkerProcess]) -> None:
    for copy in copies:
        copy.process.kill()
        copy.process.wait()
        copy.close()

"""Processes that compute points of a study: copies of this process, or processes started anew.

A copy has the task and all compiled code at once. A process that is started anew needs seconds for
that. It is used on systems other than Linux, beside other threads (a notebook), within a worker,
and in place of a copy that ended: perhaps that one could not work as a copy.

Messages between a study and its workers go over pipes: length, then a pickle.
"""

from __future__ import annotations

import gc
import os
import pickle
import signal
import struct
import subprocess
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, BinaryIO, cast

from ..base.errors import ModelError, TeleopDesignError
from ..base.machine import ONE_THREAD, Copy, can_copy, forbid_copies, has_hidden_threads, one_thread
from .evaluate import StudyTask, evaluate_unit
from .outcomes import as_row


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
        "from teleopdesign.studies.worker_processes import main; main()"
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
    from .worker_processes import work_as_copy

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


def main() -> None:
    """Receive a task, and compute its points until no more are asked for."""
    # Ctrl-C goes to all processes of a terminal: the one that asked decides what happens
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    forbid_copies()
    questions = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    _leave_terminal()
    with suppress(EOFError, OSError):  # the one that asked is gone, or needs no more
        _answer(pickle.loads(receive(questions)), questions, answers)
    os._exit(0)


def work_as_copy(
    task: StudyTask, questions: BinaryIO, answers: BinaryIO, others: Iterable[BinaryIO]
) -> None:
    """In a copy of the process that asks: compute points until no more are asked for.

    others: ends of pipes that belong to the process that asks
    """
    import numpy as np

    for pipe in others:
        pipe.close()
    _leave_terminal()
    # numbers that a user's function draws without a seed: other ones in each process
    np.random.seed()  # noqa: NPY002
    with suppress(EOFError, OSError):
        _answer(task, questions, answers)


def _leave_terminal() -> None:
    """What a user's function prints must come neither between answers nor between results."""
    os.dup2(2, 1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)


def _answer(task: StudyTask, questions: BinaryIO, answers: BinaryIO) -> None:
    """Say that this process is ready, and then answer with the outcomes of each unit at once."""
    is_loaded = False
    while True:
        send(answers, None)
        for unit in receive(questions):
            send(answers, [as_row(outcome) for outcome in evaluate_unit(task, unit)])
            if not is_loaded:  # what was imported stays: no search for unused cycles there
                gc.freeze()
                is_loaded = True


_LENGTH = struct.Struct("<Q")


def send(pipe: BinaryIO, message: Any) -> None:
    """Write a message; raises OSError: no process reads it."""
    body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    pipe.write(_LENGTH.pack(len(body)) + body)
    pipe.flush()


def receive(pipe: BinaryIO) -> Any:
    """The next message; raises EOFError: there are no more messages."""
    head = pipe.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        raise EOFError
    (length,) = _LENGTH.unpack(head)
    body = pipe.read(length)
    if len(body) < length:
        raise EOFError
    return pickle.loads(body)  # from a process of this study alone, never from a file

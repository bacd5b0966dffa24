"""A worker process that computes points of a study on this machine."""

from __future__ import annotations

import gc
import os
import pickle
import signal
from collections.abc import Iterable
from contextlib import suppress
from typing import BinaryIO

from ..base.machine import forbid_copies
from .evaluate import StudyTask
from .frames import receive, send
from .outcomes import as_row
from .side_by_side import evaluate_unit


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

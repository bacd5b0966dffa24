"""A worker process that computes points of a study on this machine."""

from __future__ import annotations

import gc
import os
import pickle
import signal

from .evaluate import StudyTask
from .frames import receive, send
from .outcomes import as_row
from .side_by_side import evaluate_unit


def main() -> None:
    """Receive a task and then units of points; return the outcomes of each unit at once."""
    # Ctrl-C goes to all processes of a terminal: the one that asked decides what happens
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    questions = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    # what a user's function prints must not come between answers
    os.dup2(2, 1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    try:
        task: StudyTask = pickle.loads(receive(questions))
        is_loaded = False
        while True:
            for unit in receive(questions):
                send(answers, [as_row(outcome) for outcome in evaluate_unit(task, unit)])
                if not is_loaded:  # what was imported stays: no search for unused cycles there
                    gc.freeze()
                    is_loaded = True
            send(answers, None)
    except (EOFError, OSError):
        os._exit(0)  # the one that asked is gone, or needs no more

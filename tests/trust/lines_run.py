"""A plugin of pytest: which lines of the package each test runs, and how long it takes.

    TELEOPDESIGN_LINES_OF=FOLDER TELEOPDESIGN_LINES_TO=FILE pytest -p lines_run tests/effects

FOLDER: folders and files, joined by ":". FILE gets, as JSON, a list of tests: name, seconds, and
by file of the package the lines. What only an import runs, or compiled code, or another process, is
in no list.
"""

import json
import os
import sys
import threading
import time
from pathlib import Path

import pytest

_WATCHED = tuple(os.environ["TELEOPDESIGN_LINES_OF"].split(":"))
_tests: list[dict[str, object]] = []
_now: dict[str, set[int]] = {}


def _within(frame, event, _):
    if event == "line":
        _now[frame.f_code.co_filename].add(frame.f_lineno)
    return _within


def _at_call(frame, event, _):
    file = frame.f_code.co_filename
    if not file.startswith(_WATCHED):
        return None
    _now.setdefault(file, set()).add(frame.f_lineno)
    return _within


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item, nextitem):
    _now.clear()
    threading.settrace(_at_call)
    sys.settrace(_at_call)
    began = time.monotonic()
    try:
        return (yield)
    finally:
        sys.settrace(None)
        threading.settrace(None)
        lines = {file: sorted(rows) for file, rows in _now.items()}
        taken = time.monotonic() - began
        _tests.append({"test": item.nodeid, "seconds": taken, "lines": lines})


def pytest_sessionfinish():
    Path(os.environ["TELEOPDESIGN_LINES_TO"]).write_text(json.dumps(_tests))

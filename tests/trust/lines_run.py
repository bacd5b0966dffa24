"""A plugin of pytest: which lines of the package each test runs, and how long it takes.

    TELEOPDESIGN_LINES_OF=FOLDER TELEOPDESIGN_LINES_TO=FILE pytest -p lines_run tests/effects

FOLDER: folders and files, joined by ":". FILE gets, as JSON, a list of tests: name, seconds, and
by file of the package the lines. What only an import runs, or compiled code, or another process, is
in no list. The loop of a simulation in plain Python counts as the file that it is written in.
"""

import ast
import json
import os
import sys
import threading
import time
from functools import cache
from pathlib import Path

import pytest

_WATCHED = tuple(os.environ["TELEOPDESIGN_LINES_OF"].split(":"))
_tests: list[dict[str, object]] = []
_now: dict[str, set[int]] = {}


@cache
def _loop_file():
    """The file whose text ends each generated module, and at which line its functions begin."""
    file = Path(sys.modules["teleopdesign.realise._loop"].__file__).with_name("integrator.py")
    functions = (f for f in ast.parse(file.read_bytes()).body if isinstance(f, ast.FunctionDef))
    return str(file), {f.name: f.decorator_list[0].lineno for f in functions}


def _place(frame):
    """File and line that a frame is at, as they were written."""
    code = frame.f_code
    if code.co_filename == "<generated>":
        file, begins = _loop_file()
        if code.co_name in begins:
            return file, begins[code.co_name] + frame.f_lineno - code.co_firstlineno
    return code.co_filename, frame.f_lineno


def _within(frame, event, _):
    if event == "line":
        file, line = _place(frame)
        _now[file].add(line)
    return _within


def _at_call(frame, event, _):
    file, line = _place(frame)
    if not file.startswith(_WATCHED):
        return None
    _now.setdefault(file, set()).add(line)
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
        duration = time.monotonic() - began
        _tests.append({"test": item.nodeid, "seconds": duration, "lines": lines})


def pytest_sessionfinish():
    Path(os.environ["TELEOPDESIGN_LINES_TO"]).write_text(json.dumps(_tests))

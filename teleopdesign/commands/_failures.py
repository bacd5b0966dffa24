"""An error that ends a command, as one line and an exit status; a traceback only on request.

Errors that the package raises on purpose say where and what. Errors of the system and of a user's
Python file are reported with the file that they come from. Any other error is a mistake of the
package, and the line says where it is.
"""

from __future__ import annotations

import argparse
import errno
import os
import traceback
from pathlib import Path

import teleopdesign

from ..base.errors import TeleopDesignError, printable
from ._paths import inputs, python_files

#: exit status of bad input, and of a mistake of the package (EX_SOFTWARE of sysexits.h)
BAD_INPUT, INTERNAL = 2, 70
#: asks for tracebacks, as the option --traceback does
TRACEBACK = "TELEOPDESIGN_TRACEBACK"
_LONGEST = 500  # most characters of another package's message


def failure(error: BaseException, options: argparse.Namespace | None) -> tuple[str, int]:
    """The line that reports an error, and the exit status."""
    if isinstance(error, TeleopDesignError):
        return str(error), BAD_INPUT
    if (place := _place_in(error, tuple(python_files(options)))) is not None:
        return _shorten(f"{place}: {_error_text(error)}"), BAD_INPUT
    read = ", ".join(map(str, inputs(options))) or "the command"
    if isinstance(error, MemoryError):
        return f"{read}: needs more memory than there is: use shorter records", BAD_INPUT
    if isinstance(error, RecursionError):
        return f"{read}: nested too deeply, expected some ten levels at most", BAD_INPUT
    if isinstance(error, UnicodeError):
        return _shorten(f"{read}: expected UTF-8 text: {error}"), BAD_INPUT
    if isinstance(error, OSError):
        return _shorten(_describe_system_error(error, read)), BAD_INPUT
    return _shorten(
        f"internal error in {_origin(error)}: {_error_text(error)}: please report it"
    ), INTERNAL


def _place_in(error: BaseException, files: tuple[Path, ...]) -> str | None:
    """File and line of the user's code in an error's traceback; None if there is none."""
    known = {os.path.realpath(path): path for path in files}
    frames = traceback.extract_tb(error.__traceback__)
    for frame in reversed(frames):
        if (path := known.get(os.path.realpath(frame.filename))) is not None:
            return f"{path}: line {frame.lineno}"
    return None


def _describe_system_error(error: OSError, read: str) -> str:
    if error.errno is None:
        return f"{read}: {_error_text(error)}"
    reason = error.strerror or os.strerror(error.errno)
    if error.filename is not None:
        return f"{os.fsdecode(error.filename)}: {reason}"
    if error.errno == errno.ENOSPC:
        return f"{reason}: what was to be written is not there"
    return f"{read}: {reason}"


def _error_text(error: BaseException) -> str:
    if isinstance(error, SystemExit):
        return "ends Python (sys.exit), expected an effect or a study alone"
    text = str(error)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _origin(error: BaseException) -> str:
    """File and line of the package's innermost frame in an error's traceback."""
    folder = Path(teleopdesign.__file__).parent
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        path = Path(frame.filename)
        if path.is_relative_to(folder):
            return f"{path.relative_to(folder).as_posix()}:{frame.lineno}"
    return "teleopdesign"


def _shorten(text: str) -> str:
    line = printable(text)
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 3]}..."

"""Arguments of `teleopdesign`, and the end of a command: an exit status and at most one line.

Errors that the package raises on purpose say where and what. Errors of the system and of a user's
Python file are reported with the file that they come from. Any other error is a mistake of the
package, and the line says where it is.

A home folder that does not exist: no library that a command imports creates it.
"""

from __future__ import annotations

import argparse
import errno
import os
import pkgutil
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

import teleopdesign

from .. import __version__, commands
from ..base.errors import TeleopDesignError, did_you_mean, printable
from ._options import check_outputs
from ._paths import check_paths, inputs, python_files
from ._terminal import plain_warnings, printable_streams

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


#: where matplotlib keeps its settings and fonts
PLACE = "MPLCONFIGDIR"


@contextmanager
def keep_home_absent() -> Iterator[None]:
    """Let matplotlib keep its files in a temporary folder if the user has no home folder.

    Otherwise matplotlib would create the home folder. A user without one wants no files to be kept
    there.
    """
    if PLACE in os.environ or Path(os.path.expanduser("~")).is_dir():
        yield
        return
    try:
        folder = tempfile.TemporaryDirectory(
            prefix="teleopdesign-matplotlib-", ignore_cleanup_errors=True
        )
    except OSError:  # nothing can be written anywhere
        yield
        return
    with folder as path:
        os.environ[PLACE] = path
        try:
            yield
        finally:
            os.environ.pop(PLACE, None)


EXAMPLES = """\
  teleopdesign new log.csv --output joint
  teleopdesign check joint
  teleopdesign diagnose joint --json answer.json --report report.html
  teleopdesign design answer.json --output design
`teleopdesign COMMAND --help` shows the arguments of a command"""


def run(arguments: Sequence[str] | None, is_stopped: Callable[[], bool] = lambda: False) -> int:
    """Run the command; returns the exit status, unless the command is stopped.

    is_stopped: whether Ctrl-C was pressed; an exception after Ctrl-C is not reported as an error
    raises KeyboardInterrupt: the command is stopped
    """
    with printable_streams(), plain_warnings(), keep_home_absent():
        try:
            return _run(arguments, is_stopped)
        except BrokenPipeError:
            close_output()  # who reads has enough, as `head` does
            return 0


def _run(arguments: Sequence[str] | None, is_stopped: Callable[[], bool]) -> int:
    options = None
    try:
        try:
            if not (sys.argv[1:] if arguments is None else arguments):
                parser().print_help(sys.stderr)
                return 2
            options = parser().parse_args(arguments)
        finally:  # also where help was shown, or a wrong argument refused
            _flush()
        check_paths(options)
        check_outputs(options)
        status: int = options.run(options)
        _flush()
        return status
    except (BrokenPipeError, KeyboardInterrupt):
        raise
    except BaseException as error:  # a user's file may raise anything, SystemExit included
        if is_stopped():
            raise KeyboardInterrupt from error
        if options is None and isinstance(error, SystemExit):
            raise
        if getattr(options, "traceback", False) or os.environ.get(TRACEBACK):
            traceback.print_exc()
        line, status = failure(error, options)
        with suppress(OSError):
            print(f"teleopdesign: {line}", file=sys.stderr)
        try:
            _flush()
        except OSError:
            close_output()
        return status


def _flush() -> None:
    if sys.stdout is not None:  # None: it was closed before Python began
        sys.stdout.flush()


def close_output() -> None:
    """Discard remaining output; at its end Python would try to write it again, and fail."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


class _Parser(argparse.ArgumentParser):
    """A parser whose refusal of a command or an option names the nearest one."""

    def parse_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> argparse.Namespace:
        options: argparse.Namespace
        options, rest = self.parse_known_args(args, namespace)
        if rest:
            command: _Parser = getattr(options, "command_parser", self)
            word = rest[0].partition("=")[0]
            near = did_you_mean(word, command._option_string_actions)
            command.error(f"unrecognized arguments: {' '.join(rest)}{near}")
        return options

    def error(self, message: str) -> NoReturn:
        word, _, choices = message.partition("invalid choice: ")[2].partition(" (choose from ")
        names = [name.strip("')") for name in choices.split(", ") if choices]
        super().error(message + did_you_mean(word.strip("'"), names))


def parser() -> argparse.ArgumentParser:
    """The parser for the arguments of all commands."""
    parser = _Parser(
        prog="teleopdesign",
        description="Friction in haptic interfaces and teleoperators: find what a model lacks.",
        epilog=f"from a log to a compensation:\n{EXAMPLES}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"teleopdesign {__version__}")
    parser.add_argument(
        "--traceback",
        action="store_true",
        help=f"also print the Python traceback of an error (as with {TRACEBACK}=1 in the "
        "environment)",
    )
    subparsers = parser.add_subparsers(required=True, metavar="COMMAND")
    for module in pkgutil.iter_modules(commands.__path__):
        if module.name.startswith("_"):
            continue
        command = import_module(f"{commands.__name__}.{module.name}")
        subparser = subparsers.add_parser(module.name.replace("_", "-"), help=command.__doc__)
        command.add(subparser)
        if examples := getattr(command, "EXAMPLES", ""):
            subparser.epilog = f"examples:\n{examples.rstrip().lstrip(chr(10))}"
            subparser.formatter_class = argparse.RawDescriptionHelpFormatter
        subparser.description = command.__doc__
        subparser.set_defaults(run=command.run, parser=parser, command_parser=subparser)
    return parser

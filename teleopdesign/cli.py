"""The command `teleopdesign`; each of its commands is a file of `commands`."""

from __future__ import annotations

import argparse
import os
import pkgutil
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module

from . import __version__, commands
from .commands._failures import TRACEBACK, failure
from .commands._paths import check_paths
from .commands._terminal import printable_streams


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status.

    0: done; 2: bad input, or a file that cannot be read or written (one line says which); 70: a
    mistake of the package (one line says where); 130: stopped
    """
    with printable_streams():
        return _run(arguments)


def _run(arguments: Sequence[str] | None) -> int:
    options = None
    try:
        try:
            options = _parser().parse_args(arguments)
        finally:  # also where help was shown, or a wrong argument refused
            _flush()
        check_paths(options)
        status: int = options.run(options)
        _flush()
        return status
    except BrokenPipeError:
        _close_output()  # who reads has enough, as `head` does
        return 0
    except KeyboardInterrupt:
        print("teleopdesign: stopped", file=sys.stderr)
        return 130
    except BaseException as error:  # a user's file may raise anything, SystemExit included
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
            _close_output()
        return status


def _flush() -> None:
    if sys.stdout is not None:  # None: it was closed before Python began
        sys.stdout.flush()


def _close_output() -> None:
    """What is left to write goes nowhere: Python would try it once more, and fail, at its end."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="teleopdesign",
        description="Friction in haptic interfaces and teleoperators: find what a model lacks.",
    )
    parser.add_argument("--version", action="version", version=f"teleopdesign {__version__}")
    parser.add_argument(
        "--traceback",
        action="store_true",
        help=f"print Python's traceback of an error too (as the environment's {TRACEBACK}=1 does)",
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
        subparser.set_defaults(run=command.run, parser=parser)
    return parser


if __name__ == "__main__":
    sys.exit(main())

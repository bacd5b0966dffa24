"""The command `teleopdesign`; each of its commands is a file of `commands`."""

from __future__ import annotations

import argparse
import os
import pkgutil
import sys
from collections.abc import Sequence
from importlib import import_module

from . import __version__, commands
from .errors import TeleopDesignError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status: 0, or 2 for bad input (one line says which)."""
    try:
        options = _parser().parse_args(arguments)
        status: int = options.run(options)
        sys.stdout.flush()
        return status
    except TeleopDesignError as error:
        print(f"teleopdesign: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        # who reads has enough, as `head` does; what is left to write goes nowhere
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        print("teleopdesign: stopped", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="teleopdesign",
        description="Friction in haptic interfaces and teleoperators: find what a model lacks.",
    )
    parser.add_argument("--version", action="version", version=f"teleopdesign {__version__}")
    subparsers = parser.add_subparsers(required=True, metavar="COMMAND")
    for module in pkgutil.iter_modules(commands.__path__):
        if module.name.startswith("_"):
            continue
        command = import_module(f"{commands.__name__}.{module.name}")
        subparser = subparsers.add_parser(module.name.replace("_", "-"), help=command.__doc__)
        command.add(subparser)
        subparser.set_defaults(run=command.run)
    return parser


if __name__ == "__main__":
    sys.exit(main())

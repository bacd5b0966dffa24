"""print a script by which a shell completes commands, options, files and effects"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ..base.errors import ModelError, unknown

EXAMPLES = """
  eval "$(teleopdesign completion bash)"           # in ~/.bashrc
  eval "$(teleopdesign completion zsh)"            # in ~/.zshrc, after compinit
  teleopdesign completion fish | source            # in ~/.config/fish/config.fish
"""
#: arguments that take effects' names: (command, or "" for any; name of the value)
_OF_EFFECTS = (("", "only"), ("", "exclude"), ("effects", "name"))


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("shell", metavar="SHELL", help="bash, zsh, fish, or tcsh")


def run(options: argparse.Namespace) -> int:
    """Print the script."""
    import shtab

    from ..effects import EFFECTS

    if options.shell not in shtab.SUPPORTED_SHELLS:
        raise ModelError(f"completion: {unknown('shell', options.shell, shtab.SUPPORTED_SHELLS)}")
    say_what_follows(options.parser, EFFECTS)
    print(shtab.complete(options.parser, options.shell))
    return 0


def say_what_follows(parser: argparse.ArgumentParser, effects: Iterable[str]) -> None:
    """Mark the arguments of every command that take files, or names of effects."""
    import shtab

    commands = next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    known = tuple(effects)
    action: Any
    for name, command in commands.choices.items():
        for action in command._actions:
            if action.type is Path:
                action.complete = shtab.FILE
            if ("", action.dest) in _OF_EFFECTS or (name, action.dest) in _OF_EFFECTS:
                action.choices = known

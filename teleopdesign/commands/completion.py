"""print a script by which bash, zsh or fish completes commands, options and effects"""

from __future__ import annotations

import argparse

from ..errors import ModelError, did_you_mean
from ._shells import SHELLS, completions

EXAMPLES = """
  eval "$(teleopdesign completion bash)"           # in ~/.bashrc
  eval "$(teleopdesign completion zsh)"            # in ~/.zshrc, after compinit
  teleopdesign completion fish | source            # in ~/.config/fish/config.fish
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("shell", metavar="SHELL", help=f"{', '.join(SHELLS)}")


def run(options: argparse.Namespace) -> int:
    """Print the script."""
    if options.shell not in SHELLS:
        raise ModelError(
            f'completion: no shell "{options.shell}", has {", ".join(SHELLS)}'
            f"{did_you_mean(options.shell, SHELLS)}"
        )
    from ..effects import EFFECTS

    print(SHELLS[options.shell](completions(options.parser, EFFECTS)), end="")
    return 0

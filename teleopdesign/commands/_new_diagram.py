"""`new` for a whole diagram: its signals among the columns of a log."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ._paths import shell_word

if TYPE_CHECKING:
    from ..block_cuts import ChannelProposal
    from ..measurement.doors._log import Log
    from ..measurement.new_folder import FitAndCheck
    from ..measurement.survey import Choices

#: options that state a channel or a value of one body
_OF_ONE_BODY = (
    *("kind", "axis", "position", "velocity", "force", "hand", "torque_constant", "lever_arm"),
    *("gear_ratio", "counts_per_turn", "inertia"),
)


def add_diagram_options(parser: argparse.ArgumentParser) -> None:
    """The options of an experiment of a diagram."""
    parser.add_argument(
        "--diagram",
        type=Path,
        metavar="FILE",
        help="compare this diagram, not one body",
    )
    parser.add_argument(
        "--signal",
        action="append",
        default=[],
        metavar="NAME=COLUMN",
        help="the column of a signal of the diagram, or none (may be repeated)",
    )


def make_diagram(
    options: argparse.Namespace,
    choices: Choices,
    log: Log,
    folder: Path,
    spans: FitAndCheck | None,
) -> int:
    """Write the folder of an experiment of a diagram, and say what each choice rests on.

    log: the first one
    raises ExperimentError: an option of one body; no such signal or column
    """
    from ..block_cuts import load_experiment, propose_channels
    from ..block_cuts.new_diagram import make_diagram_folder
    from ..diagrams import read_diagram

    if options.diagram is None:
        raise ExperimentError("--signal: is for signals of a diagram, expected --diagram FILE")
    for name in _OF_ONE_BODY:
        if getattr(options, name) is not None:
            option = name.replace("_", "-")
            raise ExperimentError(
                f"--{option}: is for experiments of one body, expected --signal NAME=COLUMN"
            )
    diagram, name = read_diagram(options.diagram), options.logs[0].name
    stated = _columns_of_signals(options.signal)
    proposal = propose_channels(diagram, log, file=name, choices=choices, stated=stated)
    if proposal.open and not options.yes and sys.stdin.isatty():
        stated |= _ask_about(proposal, input)
        proposal = propose_channels(diagram, log, file=name, choices=choices, stated=stated)
    title = options.title or name.split(".")[0]
    make_diagram_folder(proposal, options.logs, options.diagram, folder, title=title, spans=spans)
    print(
        f"{name}: {proposal}\n\n{load_experiment(folder)}\n\nwritten: {folder / 'experiment.toml'}"
    )
    if proposal.guesses:
        print(
            "if a guess is wrong: repeat the command with --signal, --unit or --time, and with "
            "--overwrite"
        )
    print(f"next: teleopdesign check {shell_word(folder)}")
    print(f"      teleopdesign diagnose {shell_word(folder)} --report report.html")
    return 0


def _columns_of_signals(texts: list[str]) -> dict[str, str]:
    """Signal -> column, of the option --signal."""
    stated = {}
    for text in texts:
        signal, equals, column = text.partition("=")
        if not equals or not signal or not column:
            raise ExperimentError(f"--signal: found {text!r}, expected NAME=COLUMN or NAME=none")
        stated[signal] = column
    return stated


def _ask_about(proposal: ChannelProposal, ask: Callable[[str], str]) -> dict[str, str]:
    """The user's columns for signals of which another choice is about as likely."""
    stated = {}
    for signal in proposal.open:
        column = proposal.channels[signal]["column"]
        why = proposal.guesses[f"channels.{signal}.column"]
        text = (
            f"{signal}: {column!r}: {why}\n  Enter accepts this; or type another column, or none: "
        )
        stated[signal] = ask(text).strip() or column
    return stated

"""`new` for what is no log of one body: signals of a diagram, a friction curve, a further log.

The signals of a diagram are looked for among the columns of a log. A friction curve is a table of
speeds and forces. A further log is one of a logger that an experiment reads already.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ..base.files import read_whole, write_text
from ._options import add_repeated, refuse_options, shell_word, split_pairs

if TYPE_CHECKING:
    from ..block_cuts import ChannelProposal
    from ..measurement.doors._log import Log
    from ..measurement.experiment import Experiment
    from ..measurement.new_folder import FitAndCheck
    from ..measurement.survey import Choices, Survey

#: options that state a channel or a value of one body
_OF_ONE_BODY = (
    *("kind", "axis", "position", "velocity", "force", "hand", "torque_constant", "lever_arm"),
    *("gear_ratio", "counts_per_turn", "inertia"),
)

#: options that state what a friction curve lacks
_OVER_TIME = ("time", "position", "sample_rate", "fit_span", "check_span")


def add_diagram_options(parser: argparse.ArgumentParser) -> None:
    """The options of an experiment of a diagram."""
    parser.add_argument(
        "--diagram",
        type=Path,
        metavar="FILE",
        help="compare this diagram, not one body",
    )
    text = "the column of a signal of the diagram, or none"
    add_repeated(parser, "--signal", "NAME=COLUMN", text)


def say_what_stops(experiment: Experiment) -> None:
    """Print each finding that keeps any diagnosis from an answer."""
    from ..check import CheckedRecording, stopping_findings

    for finding in stopping_findings(CheckedRecording(experiment)):
        print(f"\nno diagnosis can answer yet: {finding.sentence}")


def say_next(folder: Path, *, wrong: str = "") -> None:
    """Print the commands that may follow;  wrong: what replaces a wrong guess; "": none was made"""
    if wrong:
        print(f"if a guess is wrong: repeat the command with {wrong}, and with --overwrite")
    print(f"next: teleopdesign check {shell_word(folder)}")
    print(f"      teleopdesign diagnose {shell_word(folder)} --report report.html")


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
    from ..block_cuts.channel_proposal import make_diagram_folder
    from ..diagrams import read_diagram

    if options.diagram is None:
        raise ExperimentError("--signal: is for signals of a diagram, expected --diagram FILE")
    refuse_options(
        options, _OF_ONE_BODY, "is for experiments of one body, expected --signal NAME=COLUMN"
    )
    diagram, name = read_diagram(options.diagram), options.logs[0].name
    stated = split_pairs(options.signal, "--signal", "NAME=COLUMN or NAME=none")
    proposal = propose_channels(diagram, log, file=name, choices=choices, stated=stated)
    if proposal.open and not options.yes and sys.stdin.isatty():
        stated |= _ask_about(proposal)
        proposal = propose_channels(diagram, log, file=name, choices=choices, stated=stated)
    title = options.title or name.split(".")[0]
    make_diagram_folder(proposal, options.logs, options.diagram, folder, title=title, spans=spans)
    print(
        f"{name}: {proposal}\n\n{load_experiment(folder)}\n\nwritten: {folder / 'experiment.toml'}"
    )
    say_next(folder, wrong="--signal, --unit or --time" if proposal.guesses else "")
    return 0


def ask_about(guess: str, kind: str = "value") -> str:
    """The user's answer to a guess; "" accepts the guess."""
    return input(f"{guess}\n  Enter accepts this; or type another {kind}: ").strip()


def _ask_about(proposal: ChannelProposal) -> dict[str, str]:
    """The user's columns for signals of which another choice is about as likely."""
    stated = {}
    for signal in proposal.open:
        column = proposal.channels[signal]["column"]
        why = proposal.guesses[f"channels.{signal}.column"]
        stated[signal] = ask_about(f"{signal}: {column!r}: {why}", "column, or none") or column
    return stated


def make_like(
    options: argparse.Namespace, choices: Choices, folder: Path, spans: FitAndCheck | None
) -> int:
    """Write the folder of an experiment that reads its logs as another one does.

    raises ExperimentError: an option that states what the other experiment states, no experiment
        is there, or the logs cannot be read like its own
    """
    from ..block_cuts import load_experiment
    from ..measurement.experiment import Experiment, folder_of_experiment
    from ..measurement.new_folder import make_folder_like
    from ..measurement.survey import Choices

    beside = "found beside --like, which states each channel"
    refuse_options(options, ("kind", "diagram", "signal", "velocity", "inertia"), beside)
    if choices != Choices():
        raise ExperimentError("--like: found beside an option that states a channel: expected one")
    source = folder_of_experiment(options.like)
    written = folder / "experiment.toml"
    title = options.title or options.logs[0].name.split(".")[0]
    present = set(folder.iterdir()) if folder.is_dir() else None
    before = read_whole(written).decode() if written.is_file() else None
    try:
        make_folder_like(source, options.logs, folder, title=title, spans=spans)
        experiment = load_experiment(folder)
    except ExperimentError:
        _remove_new(folder, present)
        if before is not None:
            write_text(written, before)
        raise
    print(f"columns, units, signs and model are those of {options.like}\n\n{experiment}")
    if isinstance(experiment, Experiment):
        say_what_stops(experiment)
    print(f"\nwritten: {written}")
    print(f"next: teleopdesign check {shell_word(folder)}")
    return 0


def _remove_new(folder: Path, present: Collection[Path] | None) -> None:
    """Remove what a command wrote into a folder;  present: before it; None: the folder was not."""
    for path in set(folder.iterdir() if folder.is_dir() else ()) - set(present or ()):
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    if present is None and folder.is_dir():
        folder.rmdir()


def is_curve(options: argparse.Namespace, log: Log) -> bool:
    """Whether a table is read as a friction curve: as stated, or as its columns say.

    raises ExperimentError: a speed is stated of a log over time
    """
    from ..measurement.new_curve import is_over_time, looks_like_a_curve

    if options.kind is not None:
        return True
    over_time = any(getattr(options, name) for name in _OVER_TIME)
    if options.velocity is None:
        return not over_time and looks_like_a_curve(log)
    if over_time or is_over_time(log):
        raise ExperimentError(
            "--velocity: is the speed of a friction curve, found a log with a time or a position: "
            'its speed is read beside the position; expected no --velocity, or --kind "friction '
            'curve" for points of a table'
        )
    return True


def make_curve(
    options: argparse.Namespace, choices: Choices, log: Log, folder: Path, title: str
) -> int:
    """Write the folder of a friction curve, and say what was understood.

    log: the first of the tables
    raises ExperimentError: an option of a log over time
    """
    from ..measurement import load_experiment
    from ..measurement.new_curve import curve_columns, make_curve_folder

    other = (*_OVER_TIME, "hand", "lever_arm", "counts_per_turn", "inertia")
    refuse_options(options, other, "says nothing of a friction curve")
    curve = curve_columns(
        log,
        options.logs[0].name,
        axis=options.axis,
        velocity=options.velocity,
        force=options.force,
        units=choices.units,
        torque_constant=choices.torque_constant,
        gear_ratio=choices.gear_ratio,
    )
    make_curve_folder(curve, options.logs, folder, title=title)
    print(describe_survey(curve, f"{options.logs[0].name}: a friction curve"))
    print("    otherwise: --sample-rate HZ, for a log over time without its clock")
    experiment = load_experiment(folder)
    print(f"\n{experiment}")
    say_what_stops(experiment)
    print(f"\nwritten: {folder / 'experiment.toml'}")
    say_next(folder, wrong="the option")
    return 0


def describe_survey(survey: Survey, head: str) -> str:
    """Lines on what was understood, one for each channel, and on what was guessed."""
    lines = [f"{head}; {survey.axis} axis"]
    for key, entry in survey.channels.items():
        keys = ("column", "unit") if "column" in entry else entry
        rest = {k: v for k, v in entry.items() if k not in keys}
        more = ", ".join(f"{k} {_shorten(v)}" for k, v in rest.items())
        column = f'"{entry["column"]}"' if "column" in entry else _shorten(entry)
        unit = f" in {entry['unit']}" if "unit" in entry and "column" in entry else ""
        lines.append(f"  {key:<18} {column}{unit}{', ' + more if more else ''}")
    lines += [f"  {note}" for note in survey.notes]
    if survey.unused:
        lines.append("not used:")
        width = max(18, *map(len, survey.unused))
        lines += [f"  {column:<{width}} {why}" for column, why in survey.unused.items()]
    if survey.guesses:
        lines.append("guessed:")
        for key, why in survey.guesses.items():
            lines.append(f"  {key}: {why}")
            if (option := _option_of(key, survey)) and "--" not in why:
                lines.append(f"    otherwise: {option}")
    return "\n".join(lines)


def _option_of(key: str, survey: Survey) -> str:
    """The option that replaces a wrong guess; "" if no option does."""
    _, quantity, part = (*key.split("."), "", "")[:3]
    columns = {"actuator_force": "force", "interaction_force": "hand"}
    if part == "column":
        return f"--{columns.get(quantity, quantity)} COLUMN"
    if part == "unit":
        column = survey.channels.get(quantity, {}).get("column", "COLUMN")
        return f"--unit {shell_word(f'{column}=UNIT')}"
    if part == "gear_ratio":
        return "--gear-ratio N (1: none)"
    if part == "torque_constant":
        unit = survey.channels[quantity][part]["unit"]
        return f'--torque-constant "VALUE {unit}"'
    if part == "lever_arm":
        return '--lever-arm "VALUE m"'
    other = "revolute" if survey.axis == "prismatic" else "prismatic"
    return {
        "channels.position.counts_per_turn": "--counts-per-turn N",
        "model.device.axis": f"--axis {other}",
        "sample_rate": "--sample-rate HZ",
    }.get(key, "")


def _shorten(value: object) -> str:
    if isinstance(value, dict):
        return f"{value['value']:g} {value['unit']}"
    return f"{value:g}" if isinstance(value, int | float) and value is not True else str(value)

"""`new` for a table of speeds and forces: a friction curve."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ._paths import shell_word

if TYPE_CHECKING:
    from ..measurement.doors._log import Log
    from ..measurement.survey import Choices, Survey


def is_curve(options: argparse.Namespace, log: Log) -> bool:
    """Whether a table is read as a friction curve: as stated, or as its columns say."""
    from ..measurement.new_curve import looks_like_a_curve

    with_time = (options.time, options.position, options.sample_rate, options.fit_span)
    if options.kind is not None or options.velocity is not None:
        return True
    return not any(with_time) and looks_like_a_curve(log)


def make_curve(
    options: argparse.Namespace, choices: Choices, log: Log, folder: Path, title: str
) -> int:
    """Write the folder of a friction curve, and say what was understood.

    log: the first of the tables
    """
    from ..check import CheckedRecording, stopping_findings
    from ..measurement import load_experiment
    from ..measurement.new_curve import curve_columns, make_curve_folder

    curve = curve_columns(
        log,
        options.logs[0].name,
        axis=options.axis,
        velocity=options.velocity,
        force=options.force,
        units=choices.units,
        torque_constant=choices.torque_constant,
    )
    make_curve_folder(curve, options.logs, folder, title=title)
    print(_text_of(curve, options.logs[0].name))
    experiment = load_experiment(folder)
    print(f"\n{experiment}")
    for finding in stopping_findings(CheckedRecording(experiment)):
        print(f"\nno diagnosis can answer yet: {finding.sentence}")
    print(f"\nwritten: {folder / 'experiment.toml'}")
    print("if a guess is wrong: repeat the command with the option, and with --overwrite")
    print(f"next: teleopdesign check {shell_word(folder)}")
    print(f"      teleopdesign diagnose {shell_word(folder)} --report report.html")
    return 0


def _text_of(curve: Survey, name: str) -> str:
    lines = [f"{name}: a friction curve; {curve.axis} axis"]
    for channel, entry in curve.channels.items():
        lines.append(f'  {channel:<18} "{entry["column"]}" in {entry["unit"]}')
    if curve.guesses:
        lines.append("guessed:")
    lines += [f"  {key}: {why}" for key, why in curve.guesses.items()]
    lines.append("    otherwise: --sample-rate HZ, --velocity COLUMN, --force COLUMN, --unit")
    return "\n".join(lines)

"""check a recording before fitting, and say which effects it can show"""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ..base.sentences import WIDTH, wrap
from ._diagnosis import experiment_or_diagram, folder_of, stated_model
from ._options import add_experiment, add_output, shell_word, write_requested
from ._whole_diagram import check_diagram

if TYPE_CHECKING:
    from ..base.finding import Finding
    from ..measurement import Experiment
    from ..model import Model

#: columns of a line at least; what it goes on with stands under its sentence
NARROWEST, INDENT = 40, " " * 9


EXAMPLES = """
  teleopdesign check rod
  teleopdesign check rod --json findings.json
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_experiment(parser, answer=False)
    add_output(parser, "--json", "write the findings")


def run(options: argparse.Namespace) -> int:
    """Print the findings, warnings first; write the requested file."""
    from ..fitted_checks import check_experiment
    from ..measurement import Experiment
    from ..measurement.experiment import describe_content

    folder = folder_of(options.folder)
    try:
        whole = experiment_or_diagram(folder)
    except ExperimentError as problem:
        findings = _unreadable(folder, problem)
        if not findings:
            raise
    else:
        if not isinstance(whole, Experiment):
            return check_diagram(whole, options)
        experiment = whole
        print(describe_content(experiment))  # how the logs were read is among the findings
        print()
        findings = check_experiment(experiment, _model_of(experiment, options))
    print(text_of(findings))
    parts = ("topic", "concern", "stops", "where", "sentence", "numbers")
    rows = [{part: getattr(f, part) for part in parts} for f in findings]
    write_requested(options, json=lambda: {"findings": rows})
    return 0


def _model_of(experiment: Experiment, options: argparse.Namespace) -> Model | None:
    """The stated model; None if a body has no inertia, which the findings then say."""
    try:
        return stated_model(experiment, options)
    except ExperimentError:
        if any(body.inertia is None for body in experiment.bodies.values()):
            return None
        raise


def _unreadable(folder: Path, problem: ExperimentError) -> tuple[Finding, ...]:
    """Findings from the logs on records that do not have the columns or units of their description.

    Empty if the description agrees with the logs, or if the logs cannot be read.
    """
    from ..base.finding import Finding
    from ..base.toml import read_toml
    from ..measurement.survey import Choices, survey_log
    from ..measurement.tables import open_log

    place = folder if folder.is_dir() else folder.parent
    try:
        toml = read_toml(place / "experiment.toml", f"{place.name}/experiment.toml")
        files = [t.text("file") for t in toml.tables("records")]
        log = open_log(place / files[0], f"{place.name}/{files[0]}")
        survey = survey_log(log, files[0], Choices())
    except (ExperimentError, IndexError):
        return ()
    findings = [Finding("reading", "warning", f"{problem}.")]
    channels = toml.table("channels").content
    for key, entry in survey.channels.items():
        stated = channels.get(key)
        if not isinstance(stated, dict) or "column" not in entry or "column" not in stated:
            continue
        same = stated["column"] == entry["column"]
        part = "unit" if same else "column"
        if stated.get(part) == entry[part]:
            continue
        seems, written = entry[part], stated.get(part)
        text = f'channels.{key}: the log looks like {part} = "{seems}", found "{written}".'
        findings.append(Finding("reading", "note", text, where=files[0]))
    if len(findings) == 1:
        return ()
    command = f"teleopdesign new {shell_word(place / files[0])}"
    findings.append(Finding("reading", "note", f"for a description made from the log: {command}."))
    return tuple(findings)


def text_of(findings: Sequence[Finding]) -> str:
    """Warnings, then notes, then what is fine, each in the order of the checks, and a count."""
    order = ("warning", "note", "fine")
    terminal = shutil.get_terminal_size((WIDTH, 24)).columns  # of a pipe: WIDTH
    width = min(WIDTH, max(NARROWEST, terminal))
    lines = [_wrap_lines(f, width) for f in sorted(findings, key=lambda f: order.index(f.concern))]
    count = sum(f.concern == "warning" for f in findings)
    lines.append(f"\n{count or 'no'} warning{'s' if count != 1 else ''}.")
    return "\n".join(lines)


def _wrap_lines(finding: Finding, width: int) -> str:
    """A finding with each line wrapped separately; rows of a table keep columns that fit."""
    first, *more = str(finding).split("\n")
    lines = [wrap(first, rest=INDENT, width=width)]
    for line in more:
        indent = INDENT + "  " * line.startswith(" ")
        text = wrap(" ".join(line.split()), first=indent, rest=indent, width=width)
        lines.append(INDENT + line if len(INDENT + line) <= width else text)
    return "\n".join(lines)

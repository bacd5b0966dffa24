"""check a recording before fitting, and say which effects it can show"""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..plain_data import write_json
from ._diagnosis import add_experiment, experiment_of, stated_model
from ._options import check_output

if TYPE_CHECKING:
    from ..finding import Finding

#: columns of the terminal; what a line goes on with stands under its sentence
WIDTH, INDENT = 100, 9


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_experiment(parser, answer=False)
    parser.add_argument("--json", type=Path, metavar="F", help="write the findings there")


def run(options: argparse.Namespace) -> int:
    """Print the findings, warnings first; write what was asked for."""
    if options.json is not None:
        check_output(options.json, (".json",))
    from ..check.soundness_check import check_experiment

    experiment = experiment_of(options.folder)
    model = stated_model(experiment, options)
    print(experiment)
    print()
    findings = check_experiment(experiment, model)
    print(text_of(findings))
    if options.json is not None:
        content = {"findings": [finding_data(f) for f in findings]}
        write_json(options.json, content)
    return 0


def text_of(findings: Sequence[Finding]) -> str:
    """Warnings, then notes, then what is fine, each in the order found, and a count."""
    order = ("warning", "note", "fine")
    lines = [
        textwrap.fill(str(f), WIDTH, subsequent_indent=" " * INDENT, break_on_hyphens=False)
        for f in sorted(findings, key=lambda f: order.index(f.concern))
    ]
    count = sum(f.concern == "warning" for f in findings)
    lines.append(f"\n{count or 'no'} warning{'s' if count != 1 else ''}.")
    return "\n".join(lines)


def finding_data(finding: Finding) -> dict[str, Any]:
    """A finding as plain data; numbers in SI, null where there is none or it is infinite."""
    return {
        "topic": finding.topic,
        "concern": finding.concern,
        "where": finding.where,
        "sentence": finding.sentence,
        "numbers": dict(finding.numbers),
    }

"""write the report of a diagnosis: of a saved answer, or of a new diagnosis"""

from __future__ import annotations

import argparse
from pathlib import Path

from ._diagnosis import diagnosis_of, experiment_and_answer
from ._options import add_experiment, add_output, add_search, check_output
from ._report import write_page

EXAMPLES = """
  teleopdesign report answer.json
  teleopdesign report rod --answer answer.json --output rod.html
  teleopdesign report rod
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_experiment(parser)
    add_output(
        parser, "--output", "write this page, by default beside the answer or report.html", ".html"
    )
    add_search(parser)


def run(options: argparse.Namespace) -> int:
    """Write the page; with an answer, print that nothing is searched or estimated again."""
    experiment = experiment_and_answer(options)
    answer: Path | None = options.answer
    if options.output is not None:
        path = options.output
    else:
        path = Path("report.html") if answer is None else answer.with_suffix(".html")
        check_output(path, (".html",))
    diagnosis = diagnosis_of(experiment, options)
    if answer is not None:
        print(
            f"{answer}: its models are computed along the records of {experiment.folder.name}; "
            "nothing is searched or estimated again"
        )
    write_page(diagnosis, path)
    print(f"written: {path}")
    return 0

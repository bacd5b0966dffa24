"""compare a model with a recording and find the missing effect"""

from __future__ import annotations

import argparse
from pathlib import Path

from ._options import add_effect_files, add_folder, check_output, say


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_folder(parser)
    parser.add_argument("--json", type=Path, metavar="F", help="write the answer there")
    parser.add_argument(
        "--predictions",
        type=Path,
        metavar="F",
        help="write measured and modelled forces (.csv[.gz])",
    )
    parser.add_argument(
        "--figure", type=Path, metavar="F", help="write the figure (.png, .pdf, .svg)"
    )
    parser.add_argument(
        "--report", type=Path, metavar="F", help="write a page with everything (.html)"
    )
    add_effect_files(parser)


def run(options: argparse.Namespace) -> int:
    """Print the ladder; write what was asked for."""
    for path, endings in (
        (options.json, (".json",)),
        (options.predictions, (".csv", ".csv.gz")),
        (options.figure, (".png", ".pdf", ".svg")),
        (options.report, (".html",)),
    ):
        if path is not None:
            check_output(path, endings)
    from ..diagnose import find_missing
    from ..diagnose.answer import write_answer, write_predictions
    from ..effects import catalogue
    from ..measurement import load_experiment
    from ..model import Model

    experiment = load_experiment(options.folder)
    model = Model.from_experiment(experiment, catalogue(options.effect))
    print(experiment)
    print()
    diagnosis = find_missing(experiment, model, progress=say)
    say("")
    print(diagnosis)
    if options.json is not None:
        write_answer(diagnosis, options.json)
    if options.predictions is not None:
        write_predictions(diagnosis, options.predictions)
    if options.figure is not None:
        diagnosis.plot().savefig(options.figure)
    if options.report is not None:
        from ..report import write_report

        write_report(diagnosis, options.report)
    return 0

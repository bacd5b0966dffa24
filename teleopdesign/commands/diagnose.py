"""compare a model with a recording and find the missing effect"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import ExperimentError
from ..plain_data import replacing
from ._diagnosis import add_experiment, diagnosis_of, experiment_of, stated_model
from ._options import check_output, say

if TYPE_CHECKING:
    from ..diagnose import Diagnosis
    from ..measurement import Experiment


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_experiment(parser, answer=False)
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
    from ..diagnose.answer import write_answer, write_predictions

    experiment = experiment_of(options.folder)
    print(experiment)
    print()
    if experiment.arm is not None:
        return _run_arm(experiment, options)
    diagnosis = diagnosis_of(experiment, options)
    print(diagnosis)
    if options.json is not None:
        write_answer(diagnosis, options.json)
    if options.predictions is not None:
        write_predictions(diagnosis, options.predictions)
    if options.figure is not None:
        with replacing(options.figure) as part:
            diagnosis.plot().savefig(part)
    if options.report is not None:
        _write_report(diagnosis, options.report)
    for line in _next_commands(diagnosis, options.folder):
        print(line)
    return 0


def _run_arm(experiment: Experiment, options: argparse.Namespace) -> int:
    """The same for an arm: no figure and no page yet."""
    for path, option in ((options.figure, "--figure"), (options.report, "--report")):
        if path is not None:
            raise ExperimentError(f"{option}: not there for an arm: use --json or --predictions")
    from ..diagnose.arms import find_missing_in_arm
    from ..diagnose.arms.answer import write_arm_answer, write_arm_predictions

    diagnosis = find_missing_in_arm(experiment, stated_model(experiment, options), progress=say)
    say("")
    print(diagnosis)
    if options.json is not None:
        write_arm_answer(diagnosis, options.json)
    if options.predictions is not None:
        write_arm_predictions(diagnosis, options.predictions)
    return 0


def _write_report(diagnosis: Diagnosis, path: Path) -> None:
    """The page, with what was found about the recording, what is left, and what to measure next."""
    from ..check import check_experiment
    from ..next_experiment import propose
    from ..report import write_report
    from ..unexplained import where_it_fails

    say("checking the recording")
    soundness = check_experiment(diagnosis.experiment, diagnosis.before.model)
    say("describing what is left")
    left = where_it_fails(diagnosis.after, diagnosis.prepared, diagnosis.floor)
    open_questions = diagnosis.verdict == "undecided" or bool(diagnosis.groups)
    steps = propose(diagnosis, progress=say).findings() if open_questions else ()
    say("")
    write_report(diagnosis, path, soundness=soundness, unexplained=left, next_steps=steps)


def _next_commands(diagnosis: Diagnosis, folder: Path) -> list[str]:
    """What helps on from here: nothing where all is explained."""
    lines = []
    if diagnosis.groups:
        lines.append(f"what to measure to tell them: teleopdesign next {folder}")
    if diagnosis.verdict != "model_adequate" and diagnosis.more_is_missing:
        lines.append(f"where it fails: teleopdesign describe {folder}")
    return ["", *lines] if lines else []

"""compare a model with a recording and find the missing effect"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import ModelError
from ..plain_data import replacing
from ._diagnosis import add_experiment, diagnosis_of, experiment_of
from ._options import check_output, say

if TYPE_CHECKING:
    from ..diagnose import Diagnosis, SimulationComparison


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
        "--simulate",
        action="store_true",
        help="also drive the final model by the recorded command alone",
    )
    parser.add_argument(
        "--loop",
        type=float,
        nargs=2,
        metavar=("K", "B"),
        help="with --simulate: stiffness and damping (SI) of the loop that held the device",
    )
    parser.add_argument(
        "--report", type=Path, metavar="F", help="write a page with everything (.html)"
    )


def run(options: argparse.Namespace) -> int:
    """Print the ladder; write what was asked for."""
    if options.loop is not None and not options.simulate:
        raise ModelError("--loop: found without --simulate, which it belongs to")
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
    diagnosis = diagnosis_of(experiment, options)
    print(diagnosis)
    simulation = _simulation(diagnosis, options)
    if options.json is not None:
        write_answer(diagnosis, options.json, simulation=simulation)
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


def _simulation(diagnosis: Diagnosis, options: argparse.Namespace) -> SimulationComparison | None:
    """The final model driven by the recorded command, printed; None: it was not asked for."""
    if not options.simulate:
        return None
    from ..diagnose import RecordedLoop
    from ..diagnose.by_simulation import compare_by_simulation

    loop = None if options.loop is None else RecordedLoop(*options.loop)
    say("simulating the final model")
    comparison = compare_by_simulation(diagnosis.model, diagnosis.prepared, loop=loop)
    say("")
    print(f"\n{comparison}")
    return comparison


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

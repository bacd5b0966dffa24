"""compare a model with a recording and find the missing effect"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ModelError
from ..base.files import write_beside
from ._diagnosis import (
    diagnose_experiment,
    experiment_or_diagram,
    folder_of,
    print_diagnosis,
)
from ._folders import diagnose_all
from ._options import add_effect_files, add_output, add_search, count_argument, say, say_written
from ._paths import shell_word
from ._report import write_page
from ._whole_diagram import diagnose_diagram

if TYPE_CHECKING:
    from ..diagnose import Diagnosis, SimulationComparison

EXAMPLES = """
  teleopdesign diagnose rod
  teleopdesign diagnose rod --json answer.json --report report.html
  teleopdesign diagnose rod --quick --exclude cogging backlash
  teleopdesign diagnose runs/* --output answers --workers 2
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "folder",
        type=Path,
        nargs="+",
        help="folder with experiment.toml and its records; several folders need --output",
    )
    parser.set_defaults(answer=None)
    add_output(parser, "--json", "write the answer", ".json")
    add_output(parser, "--predictions", "write measured and modelled forces", ".csv", ".csv.gz")
    add_output(parser, "--figure", "write the figure", ".png", ".pdf", ".svg")
    parser.add_argument(
        "--simulate",
        action="store_true",
        help="also simulate the final model, driven by the recorded command alone",
    )
    parser.add_argument(
        "--loop",
        type=float,
        nargs=2,
        metavar=("K", "B"),
        help="with --simulate: stiffness and damping (SI) of the position loop that held the "
        "device; in an arm, each joint has such a loop",
    )
    add_output(parser, "--report", "write a report of the whole diagnosis", ".html")
    add_search(parser)
    parser.add_argument(
        "--output",
        type=Path,
        metavar="DIR",
        help="write an answer for each folder, and table.csv, to DIR; a folder that has an answer "
        "in DIR and has not changed is not diagnosed again",
    )
    parser.add_argument(
        "--workers",
        type=count_argument,
        metavar="N",
        help="processes for several folders (default: one for each core)",
    )
    add_effect_files(parser)


def run(options: argparse.Namespace) -> int:
    """Print the ladder; write the requested files.

    For several folders, returns 0 if all were diagnosed, whatever the verdicts, and 2 if one was
    not.
    """
    if options.loop is not None and not options.simulate:
        raise ModelError("--loop: found without --simulate, which it belongs to")
    if len(options.folder) > 1 or options.output is not None:
        return diagnose_all(options)
    from ..diagnose import write_answer
    from ..diagnose.predictions import write_predictions
    from ..measurement import Experiment

    folder = folder_of(*options.folder)
    whole = experiment_or_diagram(folder)
    if not isinstance(whole, Experiment):
        return diagnose_diagram(whole, options)
    experiment = whole
    print(experiment)
    print()
    diagnosis = diagnose_experiment(experiment, options)
    print_diagnosis(diagnosis)
    if not diagnosis.joints:  # of an arm, each effect states its parameters above
        print(f"\n{diagnosis.model}")
    simulation = _simulation(diagnosis, options)
    if options.json is not None:
        write_answer(diagnosis, options.json, simulation=simulation)
    if options.predictions is not None:
        write_predictions(diagnosis, options.predictions)
    if options.figure is not None:
        with write_beside(options.figure) as part:
            diagnosis.plot().savefig(part)
    if options.report is not None:
        write_page(diagnosis, options.report)
    say_written(options.report, options.json, options.predictions, options.figure)
    source = shell_word(options.json or folder)
    for line in _suggest_commands(diagnosis, source):
        print(line)
    return 0


def _simulation(diagnosis: Diagnosis, options: argparse.Namespace) -> SimulationComparison | None:
    """The final model driven by the recorded command, also printed; None without --simulate."""
    if not options.simulate:
        return None
    from ..diagnose import RecordedLoop
    from ..diagnose.by_simulation import compare_by_simulation

    loop = None if options.loop is None else RecordedLoop(*options.loop)
    say("simulating the final model")
    comparison = compare_by_simulation(diagnosis.model, diagnosis.recording.parts, loop=loop)
    say("")
    print(f"\n{comparison}")
    return comparison


def _suggest_commands(diagnosis: Diagnosis, source: str) -> list[str]:
    """Lines with the next commands, of an arm for each joint.

    source: the answer if one was written, so that no second diagnosis is needed, else the folder;
        as typed in a shell
    """
    from ..fitted_checks.bandwidth import check_bandwidth

    lines = []
    for joint, one in (diagnosis.joints or {"": diagnosis}).items():
        at = f"{source} --body {joint}" if joint else source
        if one.groups and not one.kind:
            lines.append(f"what to measure to distinguish them: teleopdesign next {at}")
        if one.verdict != "model_adequate" and one.more_is_missing:
            lines.append(f"where the model fails: teleopdesign describe {at}")
            if not (joint or one.kind):
                wrong_band = check_bandwidth(one.model, one.prepared)
                lines[:0] = [f.sentence for f in wrong_band]
    if not (diagnosis.joints or diagnosis.kind):
        lines.append(f"to design a compensation: teleopdesign design {source} --output design")
    return ["", *lines] if lines else []

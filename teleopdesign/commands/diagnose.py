"""compare a model with a recording and find the missing effect"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Sequence
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError, ModelError
from ..base.files import harmless_cell, write_text
from ..base.sentences import percent
from . import STOPPED
from ._command_line import BAD_INPUT
from ._diagnosis import (
    candidate_effects,
    diagnose_now,
    effects_by_name,
    experiment_or_diagram,
    folder_of,
    print_diagnosis,
)
from ._options import (
    add_effect_files,
    add_output,
    add_search,
    count_argument,
    make_folder,
    refuse_options,
    shell_word,
    write_requested,
)
from ._terminal import PointReporter, replace_line
from ._whole_diagram import diagnose_diagram
from .report import write_page

if TYPE_CHECKING:
    from ..diagnose import Diagnosis, SimulationComparison
    from ..measurement import Experiment
    from ..studies.folders import DiagnosedFolder

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
    add_output(parser, "--json", "write the answer")
    add_output(parser, "--predictions", "write measured and modelled forces", ".csv", ".csv.gz")
    add_output(parser, "--figure", "write the figure")
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
    parser.add_argument(
        "--verbose",
        action="store_true",
        help="also print how the log was read, what was refused and why, and the whole model",
    )
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
    """Print the verdict and the errors behind it; write the requested files.

    For several folders, returns 0 if all were diagnosed, whatever the verdicts, and 2 if one was
    not.
    """
    if options.loop is not None and not options.simulate:
        raise ModelError("--loop: found without --simulate, which it belongs to")
    if len(options.folder) > 1 or options.output is not None:
        return diagnose_all(options)
    from ..diagnose import Diagnosis, write_answer
    from ..diagnose.predictions import write_predictions
    from ..measurement import Experiment

    folder = folder_of(*options.folder)
    whole = experiment_or_diagram(folder)
    if not isinstance(whole, Experiment):
        return diagnose_diagram(whole, options)
    experiment = whole
    diagnosis = diagnose_now(experiment, options)
    assert isinstance(diagnosis, Diagnosis)
    _print(diagnosis, experiment, verbose=options.verbose)
    simulation = _simulation(diagnosis, options)
    write_requested(
        options,
        {
            "json": lambda path: write_answer(diagnosis, path, simulation=simulation),
            "predictions": lambda path: write_predictions(diagnosis, path),
            "report": lambda path: write_page(diagnosis, path, simulation),
        },
        figure=diagnosis.plot,
    )
    source = shell_word(options.json or folder)
    for line in _suggest_commands(diagnosis, source):
        print(line)
    return 0


def _print(diagnosis: Diagnosis, experiment: Experiment, *, verbose: bool) -> None:
    """Print the first screen; verbose: how the log was read, every reason and the model instead."""
    from ..show.diagnose.brief import brief_text

    if not verbose:
        print_diagnosis(brief_text(diagnosis))
        return
    print(f"{experiment}\n")
    print_diagnosis(str(diagnosis))
    if not diagnosis.joints:  # of an arm, each effect states its parameters above
        print(f"\n{diagnosis.model}")


def _simulation(diagnosis: Diagnosis, options: argparse.Namespace) -> SimulationComparison | None:
    """The final model driven by the recorded command, also printed; None without --simulate."""
    if not options.simulate:
        return None
    from ..diagnose import RecordedLoop
    from ..diagnose.by_simulation import compare_by_simulation

    loop = None if options.loop is None else RecordedLoop(*options.loop)
    replace_line("simulating the final model")
    comparison = compare_by_simulation(diagnosis.model, diagnosis.recording.parts, loop=loop)
    replace_line("")
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
    return lines


#: the table within the output folder
TABLE = "table.csv"
_HEAD = ("folder", "verdict", "missing", "error before", "error after")


def diagnose_all(options: argparse.Namespace) -> int:
    """Diagnose every folder, print and write the table; returns 2 if one was not diagnosed."""
    if options.output is None:
        raise ExperimentError(f"{len(options.folder)} folders: expected --output DIR beside them")
    refuse_options(
        options,
        ("json", "predictions", "figure", "report", "simulate"),
        "is for one folder, found it with --output: every answer goes there, and `teleopdesign "
        "report ANSWER` makes its page",
    )
    for folder in options.folder:
        if not folder.is_dir():
            raise ExperimentError(f"{folder}: no such folder")
    from ..studies.folders import diagnose_folders

    known = effects_by_name(options)
    among = candidate_effects(known, options.only, options.exclude)
    output = make_folder(options.output)

    reporter = PointReporter()
    try:
        rows = diagnose_folders(
            options.folder,
            output,
            known=dict(known),
            among=among,
            quick=options.quick,
            workers=options.workers,
            progress=reporter,
        )
    except KeyboardInterrupt:
        reporter.clear()
        print(
            f"teleopdesign: stopped; {reporter.describe_finished()} kept in {output}, "
            "the same command continues from there",
            file=sys.stderr,
        )
        return STOPPED
    reporter.clear()
    print("\n".join(table_lines(rows)))
    write_text(output / TABLE, table_csv(rows))
    failed = sum(bool(row.failure) for row in rows)
    print(f"\n{len(rows) - failed} of {len(rows)} folders diagnosed; answers and {TABLE}: {output}")
    return BAD_INPUT if failed else 0


def table_lines(rows: Sequence[DiagnosedFolder]) -> list[str]:
    """The table for a terminal: a line for each folder, in the order of the command line."""
    cells = [_HEAD, *(_cells(row) for row in rows if not row.failure)]
    widths = [max(len(line[k]) for line in cells) for k in range(len(_HEAD))]
    widths[0] = max(widths[0], *(len(str(row.folder)) for row in rows))
    lines = [_line(_HEAD, widths)]
    for row in rows:
        if row.failure:
            lines.append(f"{str(row.folder):<{widths[0]}}  failed: {row.failure}")
        else:
            lines.append(_line(_cells(row), widths))
    return lines


def _cells(row: DiagnosedFolder) -> tuple[str, ...]:
    return (
        str(row.folder),
        row.verdict,
        row.missing or "-",
        percent(row.before, unknown="not told"),
        percent(row.after, unknown="not told"),
    )


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    words = [f"{cell:<{width}}" for cell, width in zip(cells[:3], widths, strict=False)]
    numbers = [f"{cell:>{width}}" for cell, width in zip(cells[3:], widths[3:], strict=True)]
    return "  ".join([*words, *numbers])


def table_csv(rows: Sequence[DiagnosedFolder]) -> str:
    """The table as CSV for a spreadsheet; errors are fractions of the measured force."""
    text = StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(
        ["folder", "answer", "verdict", "missing", "error_before", "error_after", "failure"]
    )
    for row in rows:
        numbers = ["" if not math.isfinite(x) else f"{x:.6g}" for x in (row.before, row.after)]
        answer = "" if row.failure else row.answer.name
        words = [str(row.folder), answer, row.verdict, row.missing]
        out.writerow([*map(harmless_cell, words), *numbers, harmless_cell(row.failure)])
    return text.getvalue()

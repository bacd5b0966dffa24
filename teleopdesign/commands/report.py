"""write the report of a diagnosis: of a saved answer, or of a new diagnosis"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ModelError
from ._diagnosis import diagnosis_of, experiment_and_answer
from ._options import add_experiment, add_output, add_search, check_output
from ._terminal import replace_line
from ._whole_diagram import diagnosed_diagram

if TYPE_CHECKING:
    from ..base.finding import Finding
    from ..block_cuts import BlockDiagnosis
    from ..diagnose import Diagnosis, SimulationComparison

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
    if (whole := diagnosed_diagram(options)) is not None:
        return report_diagram(whole, options)
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


def report_diagram(diagnosis: BlockDiagnosis, options: argparse.Namespace) -> int:
    """Write the page of a whole diagram."""
    from ..show.block_cuts.text import write_block_report

    answer: Path | None = options.answer
    beside = Path("report.html") if answer is None else answer.with_suffix(".html")
    write_block_report(diagnosis, options.output or beside)
    print(f"written: {options.output or beside}")
    return 0


def write_page(
    diagnosis: Diagnosis, path: Path, simulation: SimulationComparison | None = None
) -> None:
    """Write the page, with findings on the recording, the residual, and what to measure next.

    simulation: of the final model; None: it is simulated here, driven freely
    """
    from ..diagnose.by_simulation import simulated_if_possible
    from ..fitted_checks import check_experiment
    from ..show.figures.friction_curve import curve_finding
    from ..show.report import write_report
    from ..unexplained import where_it_fails

    replace_line("checking the recording")
    before = None if diagnosis.joints else diagnosis.before.model
    soundness = check_experiment(diagnosis.experiment, before)
    left = {}
    for part, one in (diagnosis.joints or {"": diagnosis}).items():
        replace_line(f"describing what is left{f' at {part}' if part else ''}")
        left[part] = where_it_fails(one.model, one.prepared, one.floor)
        if one.kind:
            left[part] = (curve_finding(one), *left[part])
    steps = _next_steps(diagnosis)
    replace_line("simulating the final model")
    simulation = simulation or simulated_if_possible(diagnosis)
    replace_line("")
    write_report(
        diagnosis,
        path,
        soundness=soundness,
        unexplained=left,
        next_steps=steps,
        simulation=simulation,
    )


def _next_steps(diagnosis: Diagnosis) -> tuple[Finding, ...]:
    """What to measure next; nothing where nothing is open, or no motion was shown to be safe."""
    from ..next_experiment import propose, shown_limits

    if (
        diagnosis.joints
        or diagnosis.kind
        or (diagnosis.verdict != "undecided" and not diagnosis.groups)
    ):
        return ()
    try:
        shown_limits(diagnosis.prepared)
    except ModelError:
        return ()
    return propose(diagnosis, progress=replace_line).findings()

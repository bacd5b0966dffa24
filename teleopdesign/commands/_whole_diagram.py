"""What commands print and write for a whole diagram: `diagnose`, `check` and `next`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ModelError
from ..base.files import write_beside
from ..base.toml import read_toml
from ._diagnosis import candidate_effects, effects_by_name, print_diagnosis
from ._options import say_written
from ._progress import Reporter

if TYPE_CHECKING:
    from ..block_cuts import DiagramExperiment

#: options of `diagnose` that ask for what only an experiment of bodies has
_OF_BODIES = ("predictions", "simulate", "loop")


def diagnose_diagram(experiment: DiagramExperiment, options: argparse.Namespace) -> int:
    """Compare every tested block; print the ladder; write the requested files.

    raises ModelError: an option that only an experiment of bodies has
    """
    from ..block_cuts.diagnosis import BlockDiagnosis, write_answer
    from ..block_cuts.search import find_missing
    from ..diagnose.search_plan import PLAN, QUICK

    for name in _OF_BODIES:
        if getattr(options, name):
            raise ModelError(f"--{name}: is for experiments of bodies, found a whole diagram")
    known = effects_by_name(options)
    reporter = Reporter()
    print(experiment)
    print()
    diagnosis = find_missing(
        experiment,
        progress=reporter,
        plan=QUICK if options.quick else PLAN,
        among=candidate_effects(known, options.only, options.exclude),
        known=known,
    )
    reporter.clear()
    assert isinstance(diagnosis, BlockDiagnosis)
    print_diagnosis(str(diagnosis))
    if options.json is not None:
        write_answer(diagnosis, options.json)
    if options.figure is not None:
        with write_beside(options.figure) as part:
            diagnosis.plot().savefig(part)
    if options.report is not None:
        from ..show.block_cuts.report import write_block_report

        write_block_report(diagnosis, options.report)
    say_written(options.report, options.json, options.figure)
    return 0


def check_diagram(experiment: DiagramExperiment, options: argparse.Namespace) -> int:
    """Print the cuts of a whole diagram, and whether the rows are passes of its computer.

    raises ModelError: --json, which only an experiment of bodies has
    """
    from ..block_cuts.computer import UnevenRows, passes_of

    if options.json is not None:
        raise ModelError("--json: is for experiments of bodies, found a whole diagram")
    print(experiment)
    for log in experiment.logs if experiment.cuts.of("computer") else ():
        try:
            passes_of(experiment, log)
        except UnevenRows as problem:
            print(f"warning: the computer is untested: {problem}")
    return 0


def is_diagram(path: Path) -> bool:
    """Whether a path is the file of a diagram, not of an experiment."""
    if path.suffix != ".toml" or not path.is_file():
        return False
    head = read_toml(path, path.name).content.get("diagram", {})
    return "file" not in head and ("kind" in head or "name" in head)


def print_what_to_log(path: Path) -> int:
    """Print what must be recorded to test every block of a diagram."""
    from ..block_cuts.what_to_log import what_to_log
    from ..diagrams import read_diagram

    print(what_to_log(read_diagram(path)))
    return 0

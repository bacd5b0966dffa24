"""What `diagnose` prints and writes for an experiment of a whole diagram."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ..base.errors import ModelError
from ..base.files import write_beside
from ._diagnosis import candidate_effects, effects_by_name, print_diagnosis
from ._options import say_written
from ._progress import Reporter

if TYPE_CHECKING:
    from ..block_cuts import DiagramExperiment

#: options of `diagnose` that ask for what only an experiment of bodies has
_OF_BODIES = ("predictions", "simulate", "loop", "report")


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
    )
    reporter.clear()
    assert isinstance(diagnosis, BlockDiagnosis)
    print_diagnosis(diagnosis)
    if options.json is not None:
        write_answer(diagnosis, options.json)
    if options.figure is not None:
        with write_beside(options.figure) as part:
            diagnosis.plot().savefig(part)
    say_written(options.json, options.figure)
    return 0

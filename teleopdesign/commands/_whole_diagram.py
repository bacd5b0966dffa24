"""What commands print and write for a whole diagram: `diagnose`, `check` and `next`."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.toml import read_toml
from ._diagnosis import (
    answer_in,
    diagnose_now,
    effects_by_name,
    experiment_or_diagram,
    print_diagnosis,
)
from ._options import refuse_options, write_requested

if TYPE_CHECKING:
    from ..block_cuts import BlockDiagnosis, DiagramExperiment

WHY = "is for experiments of bodies, found a whole diagram"
#: options of other commands that ask for one body
_OF_ONE_BODY = ("as_is", "effect_file", "simulate", "limit")
#: options of `diagnose` that ask for what only an experiment of bodies has
_OF_BODIES = ("predictions", "simulate", "loop")


def diagnose_diagram(experiment: DiagramExperiment, options: argparse.Namespace) -> int:
    """Compare every tested block; print the ladder; write the requested files.

    raises ExperimentError: an option that only an experiment of bodies has
    """
    from ..block_cuts import BlockDiagnosis, write_answer

    refuse_options(options, _OF_BODIES, WHY)
    print(f"{experiment}\n")
    diagnosis = diagnose_now(experiment, options)
    assert isinstance(diagnosis, BlockDiagnosis)
    print_diagnosis(str(diagnosis))
    from ..show.block_cuts.text import write_block_report

    write_requested(
        options,
        {
            "json": lambda path: write_answer(diagnosis, path),
            "report": lambda path: write_block_report(diagnosis, path),
        },
        figure=diagnosis.plot,
    )
    return 0


def check_diagram(experiment: DiagramExperiment, options: argparse.Namespace) -> int:
    """Print the cuts of a whole diagram, and whether the rows are passes of its computer.

    raises ExperimentError: --json, which only an experiment of bodies has
    """
    from ..block_cuts.channel_doubts import doubt_channels
    from ..block_cuts.computer import UnevenRows, passes_of

    refuse_options(options, ("json",), WHY)
    print(experiment)
    for log in experiment.logs if experiment.cuts.of("computer") else ():
        try:
            passes_of(experiment, log)
        except UnevenRows as problem:
            print(f"warning: the computer is untested: {problem}")
    if doubt := doubt_channels(experiment):
        print(f"warning: {doubt}")
    return 0


def diagnosed_diagram(options: argparse.Namespace) -> BlockDiagnosis | None:
    """The diagnosis of a whole diagram: read from an answer, or computed now; None: of bodies.

    raises ExperimentError: an option that asks for one body
    """
    from ..block_cuts import BlockDiagnosis, load_answer
    from ..block_cuts.saved import is_block_answer

    answer = options.answer or answer_in(options.folder)
    if answer is None and "diagram" not in _head(options.folder):
        return None
    if answer is not None and not is_block_answer(answer):
        return None
    refuse_options(options, _OF_ONE_BODY, WHY)
    if answer is not None:
        options.answer = answer
        diagnosis = load_answer(answer, effects_by_name(options))
    else:
        diagnosis = diagnose_now(experiment_or_diagram(options.folder), options)
    assert isinstance(diagnosis, BlockDiagnosis)
    return diagnosis


def _head(folder: Path) -> Mapping[str, Any]:
    """The tables of the experiment in a folder; blank where there is none."""
    path = folder / "experiment.toml" if folder.is_dir() else folder
    return read_toml(path, path.name).content if path.suffix == ".toml" and path.is_file() else {}


def describe_diagram(diagnosis: BlockDiagnosis, options: argparse.Namespace) -> int:
    """Print the ladder, and what the residual of each body depends on."""
    from ..unexplained import describe_residual

    print_diagnosis(str(diagnosis))
    described = {}
    for name, body in diagnosis.bodies.items():
        described[name] = describe_residual(body.model, body.prepared, body.floor)
        print(f"\n{name}\n{described[name]}")
    write_requested(options, json=lambda: {name: one.as_data() for name, one in described.items()})
    return 0


def print_next(diagnosis: BlockDiagnosis) -> int:
    """Print the signals that tell the open effects apart, or test what is untested."""
    from ..block_cuts import what_to_log

    print_diagnosis(str(diagnosis))
    if diagnosis.verdict == "model_adequate" and not diagnosis.cuts.untested:
        print("\nNothing more is needed: every block is tested, and what is left is noise.")
        return 0
    plan = what_to_log(diagnosis.experiment.diagram)
    places = {at for group in diagnosis.groups for _, at in group}
    apart = [s for c in diagnosis.cuts.tested if places & set(c.blocks) for s in c.separating]
    logged = [one.name for one in plan.signals if one.needed or one.name in apart]
    wanted = [name for name in logged if name not in diagnosis.experiment.recorded]
    print(f"\nrecord next: {', '.join(wanted) or 'the same signals, with a stronger motion'}")
    print(f"\n{plan.code}")
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

"""`new` for further logs of a logger that an experiment reads already."""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ..base.files import read_whole, write_text
from ._paths import shell_word

if TYPE_CHECKING:
    from ..measurement.new_folder import FitAndCheck
    from ..measurement.survey import Choices


def make_like(
    options: argparse.Namespace, choices: Choices, folder: Path, spans: FitAndCheck | None
) -> int:
    """Write the folder of an experiment that reads its logs as another one does.

    raises ExperimentError: an option that states what the other experiment states, no experiment
        is there, or the logs cannot be read like its own
    """
    from ..block_cuts import load_experiment
    from ..check import CheckedRecording, stopping_findings
    from ..measurement.experiment import Experiment, folder_of_experiment
    from ..measurement.new_like import make_folder_like
    from ..measurement.survey import Choices

    stated = [
        n for n in ("kind", "diagram", "signal", "velocity", "inertia") if getattr(options, n)
    ]
    if stated or choices != Choices():
        raise ExperimentError("--like: found beside an option that states a channel: expected one")
    source = folder_of_experiment(options.like)
    written = folder / "experiment.toml"
    title = options.title or options.logs[0].name.split(".")[0]
    present = set(folder.iterdir()) if folder.is_dir() else None
    before = read_whole(written).decode() if written.is_file() else None
    try:
        make_folder_like(source, options.logs, folder, title=title, spans=spans)
        experiment = load_experiment(folder)
    except ExperimentError:
        _remove_new(folder, present)
        if before is not None:
            write_text(written, before)
        raise
    print(f"columns, units, signs and model are those of {options.like}\n\n{experiment}")
    if isinstance(experiment, Experiment):
        for finding in stopping_findings(CheckedRecording(experiment)):
            print(f"\nno diagnosis can answer yet: {finding.sentence}")
    print(f"\nwritten: {written}")
    print(f"next: teleopdesign check {shell_word(folder)}")
    return 0


def _remove_new(folder: Path, present: Collection[Path] | None) -> None:
    """Remove what a command wrote into a folder;  present: before it; None: the folder was not."""
    for path in set(folder.iterdir() if folder.is_dir() else ()) - set(present or ()):
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    if present is None and folder.is_dir():
        folder.rmdir()

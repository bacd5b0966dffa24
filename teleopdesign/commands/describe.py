"""describe where a model fails, and the force that no candidate effect explains"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ModelError
from ._arms import add_body
from ._diagnosis import diagnosis_of_part, experiment_and_answer, stated_model
from ._options import add_experiment, add_output, shell_word, write_requested
from ._whole_diagram import describe_diagram, diagnosed_diagram

if TYPE_CHECKING:
    from ..diagnose.noise_floor import NoiseFloor
    from ..measurement.prepare import Prepared
    from ..model import Model
    from ..unexplained import ResidualDescription


EXAMPLES = """
  teleopdesign describe answer.json
  teleopdesign describe rod --as-is --figure left.png
  teleopdesign describe rod --effect-file own_drag.py
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_experiment(parser)
    add_body(parser)
    parser.add_argument(
        "--as-is",
        action="store_true",
        help="describe where the model of experiment.toml fails: its parameters are estimated "
        "again, no effect is added",
    )
    add_output(parser, "--figure", "write the figure")
    add_output(parser, "--json", "write the description")
    add_output(
        parser,
        "--effect-file",
        "write the strongest dependence of the unexplained force as an effect file for "
        "`diagnose --effect`",
        ".py",
    )


def run(options: argparse.Namespace) -> int:
    """Print the sentences; write the requested files."""
    if options.effect_file is not None and not options.effect_file.stem.isidentifier():
        raise ModelError(f"{options.effect_file}: expected a name such as my_effect.py")
    if (whole := diagnosed_diagram(options)) is not None:
        return describe_diagram(whole, options)
    from ..unexplained import describe_residual

    model, prepared, floor, model_text = _model_to_describe(options)
    print(f"{model_text}\n")
    description = describe_residual(model, prepared, floor)
    print(description)
    write_requested(
        options,
        json=lambda: {"model": model_text, **description.as_data()},
        figure=description.plot,
    )
    if options.effect_file is not None:
        _write(description, options.effect_file, options.folder)
    return 0


def _model_to_describe(
    options: argparse.Namespace,
) -> tuple[Model, Prepared, NoiseFloor | None, str]:
    """The model, its data, its noise floor (if a diagnosis states one), and words for the model."""
    from ..diagnose.stated_fit import estimate_stated
    from ..measurement.prepare import prepare

    experiment = experiment_and_answer(options)
    if options.as_is and options.answer is None and experiment.arm is None:
        model = stated_model(experiment, options)
        prepared = prepare(experiment)
        stated = estimate_stated(model, prepared).model
        return stated, prepared, None, "Your model, re-estimated:"
    diagnosis = diagnosis_of_part(experiment, options)
    prepared, before = diagnosis.prepared, diagnosis.before.model
    added = ", ".join(str(r.added) for r in diagnosis.rungs if r.added is not None)
    if options.as_is:
        return before, prepared, None, "Your model, re-estimated:"
    if not added:
        return before, prepared, diagnosis.floor, "Your model, re-estimated:"
    if not diagnosis.more_is_missing or diagnosis.missing:
        return diagnosis.model, prepared, diagnosis.floor, f"Your model with {added}:"
    return (
        before,
        prepared,
        None,
        f"Your model, re-estimated ({added} would explain less than half of what it leaves):",
    )


def _write(description: ResidualDescription, path: Path, folder: Path) -> None:
    from ..unexplained.effect_file import write_effect

    largest = description.largest
    if largest is None:
        raise ModelError(f"{path}: not written: no dependence of the unexplained force is sure")
    part, described = largest
    write_effect(path, part, described, description.prepared)
    command = f"teleopdesign diagnose {shell_word(folder)} --effect {shell_word(path)}"
    print(f"\nwritten: {path}; next: {command}")

"""make an experiment from a log: find its columns, units and signs, and ask what is not clear"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.errors import ExperimentError
from ._new_kinds import (
    add_diagram_options,
    ask_about,
    describe_survey,
    is_curve,
    make_curve,
    make_diagram,
    make_like,
    say_next,
    say_what_stops,
)
from ._options import add_repeated, split_pairs

if TYPE_CHECKING:
    from ..measurement.experiment import Experiment
    from ..measurement.new_folder import FitAndCheck
    from ..measurement.survey import Choices, Survey

EXAMPLES = """
  teleopdesign new log.csv                          looks, asks, writes log/experiment.toml
  teleopdesign new log.csv --yes                    accepts every guess
  teleopdesign new a.mat b.mat --output arm         fits on a.mat, checks on b.mat
  teleopdesign new log.csv --fit-span 5 40 --check-span 45 60
  teleopdesign new log.csv --torque-constant "0.037 N*m/A" --gear-ratio 50
  teleopdesign new log.csv --diagram interface.toml     the signals of a whole diagram
  teleopdesign new second.csv --like first_experiment   a further log of the same logger
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "logs",
        nargs="+",
        type=Path,
        metavar="LOG",
        help="log file: csv of any dialect, xlsx, mat, parquet, npz, h5, bag or mcap; of several "
        "files, the last one is the check record",
    )
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="folder of the experiment")
    parser.add_argument(
        "--overwrite", action="store_true", help="replace an existing experiment.toml"
    )
    parser.add_argument("--yes", action="store_true", help="accept every guess without a question")
    parser.add_argument("--title", help="title of the experiment (default: the name of the log)")
    parser.add_argument("--kind", choices=("friction curve",), help="a table of points, no time")
    parser.add_argument(
        "--like",
        type=Path,
        metavar="FOLDER",
        help="an experiment of the same logger: its columns, units, signs and model",
    )
    add_diagram_options(parser)
    parser.add_argument("--axis", choices=("prismatic", "revolute"), help="kind of motion")
    for name, text in (
        ("time", "time"),
        ("position", "the position"),
        ("velocity", "the speed of a friction curve"),
        ("force", "the force or current commanded to the actuator"),
        ("hand", "the measured force of the hand or environment, or none"),
    ):
        parser.add_argument(f"--{name}", metavar="COLUMN", help=f"the column of {text}")
    add_repeated(parser, "--unit", "COLUMN=UNIT", "the unit of a column")
    for option, text in (
        ("torque-constant", 'torque constant of the motor, such as "0.037 N*m/A"'),
        (
            "lever-arm",
            'for a force in N beside an angle: its distance from the axis, such as "70 mm"',
        ),
    ):
        parser.add_argument(f"--{option}", metavar="VALUE", help=text)
    for option, unit, text in (
        ("gear-ratio", "N", "turns of the motor per turn of the joint"),
        ("counts-per-turn", "N", "counts of the encoder per turn"),
        ("sample-rate", "HZ", "sample rate of a log without time"),
    ):
        parser.add_argument(f"--{option}", type=float, metavar=unit, help=text)
    parser.add_argument("--inertia", type=float, help="inertia of the body, if known, kg or kg*m^2")
    _add_spans(parser)


def _add_spans(parser: argparse.ArgumentParser) -> None:
    for use, text in (
        ("fit", "on which the model is fitted"),
        ("check", "on which errors are computed"),
    ):
        parser.add_argument(
            f"--{use}-span",
            nargs=2,
            type=float,
            metavar=("BEGIN", "END"),
            help=f"the part of a single log {text}, in s from the first row",
        )


def run(options: argparse.Namespace) -> int:
    """Survey the logs, ask, write the folder and a picture of what was understood."""
    from ..base.machine import one_thread

    import_module("numpy")  # a library is limited when it is there
    with one_thread():  # threads that wait take a third more time
        return _run(options)


def _run(options: argparse.Namespace) -> int:
    from ..measurement import load_experiment
    from ..measurement.new_folder import make_folder, require_new
    from ..measurement.survey import require_same_columns, survey_logs
    from ..measurement.tables import open_log

    if missing := [path for path in options.logs if not path.exists()]:
        raise ExperimentError(f"{missing[0]}: no such file")
    choices, spans = _choices(options), _spans(options)
    stem = options.logs[0].name.split(".")[0] or "experiment"
    folder = options.output or Path(f"{stem}_experiment")
    if not options.overwrite:
        require_new(folder)
    if options.like is not None:
        return make_like(options, choices, folder, spans)
    logs = [open_log(path, path.name) for path in options.logs]
    files = [path.name for path in options.logs]
    require_same_columns(logs, files)
    if options.diagram or options.signal:
        return make_diagram(options, choices, logs[0], folder, spans)
    if is_curve(options, logs[0]):
        return make_curve(options, choices, logs[0], folder, options.title or stem)
    survey = survey_logs(logs, files, choices)
    ask = not options.yes and sys.stdin.isatty()
    if ask:
        choices = _ask_about(survey, choices)
        survey = survey_logs(logs, files, choices)
    make_folder(
        survey,
        options.logs,
        folder,
        title=options.title or stem,
        inertia=options.inertia,
        spans=spans,
        overwrite=options.overwrite,
    )
    head = f"{options.logs[0].name}: {survey.duration:.4g} s, {len(survey.columns)} columns"
    print(describe_survey(survey, head))
    if survey.guesses and not options.yes and not ask:
        print("\nno terminal to ask on: every guess is accepted, as with --yes")
    experiment = load_experiment(folder)
    print()
    print(experiment)
    say_what_stops(experiment)
    _write_picture(survey, experiment, folder)
    return 0


def _write_picture(survey: Survey, experiment: Experiment, folder: Path) -> None:
    """Draw what was understood, and say what may follow."""
    from ..show.figures.log import draw_survey, save_survey
    from ..show.figures.style import explain_boxes

    picture = folder / "understood.png"
    save_survey(draw_survey(survey, experiment), picture)
    print(f"\nwritten: {folder / 'experiment.toml'}, {picture}")
    if boxes := explain_boxes(survey.columns):
        print(boxes)
    say_next(folder, wrong="the option below the guess" if survey.guesses else "")


def _spans(options: argparse.Namespace) -> FitAndCheck | None:
    """The fit span and the check span (s), or None if neither is given.

    raises ExperimentError: only one of them is given
    """
    fit, check = options.fit_span, options.check_span
    if fit is None and check is None:
        return None
    if fit is None or check is None:
        present, lacking = ("--check-span", "--fit-span")[:: 1 if fit is None else -1]
        raise ExperimentError(f"{present}: found alone, expected {lacking} beside it")
    return (fit[0], fit[1]), (check[0], check[1])


def _choices(options: argparse.Namespace) -> Choices:
    from ..measurement.description import lever_arm, motor_constant
    from ..measurement.survey import Choices

    constant, arm = options.torque_constant, options.lever_arm
    same = ("axis", "time", "position", "gear_ratio", "counts_per_turn", "sample_rate")
    return Choices(
        **{name: getattr(options, name) for name in same},
        actuator_force=options.force,
        interaction_force=options.hand,
        units=split_pairs(options.unit, "--unit", "COLUMN=UNIT", at_last=True),
        torque_constant=constant and motor_constant(constant, where="--torque-constant"),
        lever_arm=arm and lever_arm(arm, where="--lever-arm"),
    )


def _ask_about(survey: Survey, choices: Choices) -> Choices:
    """The choices, with the user's answers on the guesses; an empty answer accepts a guess."""
    from ..measurement.description import lever_arm, motor_constant, plain_number

    numbers: dict[str, Callable[..., Any]] = {
        "torque_constant": motor_constant,
        "lever_arm": lever_arm,
        **dict.fromkeys(("counts_per_turn", "gear_ratio", "sample_rate"), plain_number),
    }
    units = dict(choices.units)
    for key, why in list(survey.guesses.items()):
        _, quantity, part = (*key.split("."), "", "")[:3]
        name = {"model.device.axis": "axis", "sample_rate": key}.get(key, part)
        if name not in ("unit", "column", "axis", *numbers):
            continue
        if not (answer := ask_about(f"{key}: {why}")):
            continue
        value: Any = numbers[name](answer, where=key) if name in numbers else answer
        if name == "unit":
            units[survey.channels[quantity]["column"]] = answer
        else:
            choices = replace(choices, **{quantity if name == "column" else name: value})
    return replace(choices, units=units)
